// Light of the air as rays from outside see it: of rays that meet the ground, by the cosine of its
// zenith angle there; of those past the limb, by their least height. The Sun stands by its height
// and azimuth at that place.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "light/air.h"

namespace panwright::light {
namespace {

constexpr int kRows[] = {24, 36};  // of the ground, of the limb
constexpr int kSuns = 72, kAzimuths = 6;
constexpr std::size_t kValues = 6;
constexpr double kLowest = -0.36;  // sine of the Sun's height, where the air is dark

double sun_place(double mu) {
  const double low = -std::sqrt(-kLowest);
  const double root = mu < 0 ? -std::sqrt(-mu) : std::sqrt(mu);
  return std::clamp((root - low) / (1 - low), 0.0, 1.0);
}
double sun_of(double place) {
  const double low = -std::sqrt(-kLowest);
  const double root = low + place * (1 - low);
  return root * std::fabs(root);
}

struct Node {
  std::size_t first;
  double next;  // weight
};
Node node_at(double place, int count) {
  const double x = std::clamp(place, 0.0, 1.0) * (count - 1);
  const double node = std::min(std::floor(x), count - 2.0);
  return {static_cast<std::size_t>(node), x - node};
}

float fourth_root(double x) { return static_cast<float>(std::sqrt(std::sqrt(std::max(x, 0.0)))); }

// Geometry of a ray: towards x, past or into a place on z.
struct Look {
  Vec3 origin, ray, sun;
};
Look look(double r, double mu, double mu_sun, double cosine_azimuth, double top) {
  const double across = std::sqrt(std::max(0.0, 1 - mu_sun * mu_sun));
  const double beside = std::sqrt(std::max(0.0, 1 - cosine_azimuth * cosine_azimuth));
  Look result;
  result.ray = Vec3(std::sqrt(1 - mu * mu), 0, -mu);
  result.sun = Vec3(across * cosine_azimuth, across * beside, mu_sun);
  result.origin = Vec3(0, 0, r) - 2 * top * result.ray;
  return result;
}

}  // namespace

void Air::fill_seen() {
  for (int limb = 0; limb < 2; ++limb) {
    const int rows = kRows[limb];
    std::vector<float>& table = seen_[limb];
    table.resize(kValues * static_cast<std::size_t>(rows * kSuns * kAzimuths));
    parallel_for(static_cast<std::size_t>(rows), [&](std::size_t row) {
      const double u = static_cast<double>(row) / (rows - 1);
      const double r = limb ? std::max(1 + (top_ - 1) * u * u, 1 + 1e-9) : 1;
      const double mu = limb ? 0 : std::max(u * u, 1e-4);
      float* out = &table[kValues * row * kSuns * kAzimuths];
      for (int i = 0; i < kSuns; ++i)
        for (int j = 0; j < kAzimuths; ++j, out += kValues) {
          const double azimuth = 1 - 2.0 * j / (kAzimuths - 1);
          const Look at = look(r, mu, sun_of(static_cast<double>(i) / (kSuns - 1)), azimuth, top_);
          const Sums sums = march(at.origin, at.ray, at.sun, {limb ? 40 : 32, false});
          const double phase = rayleigh_phase(glm::dot(at.ray, at.sun));
          for (int k = 0; k < 3; ++k) {
            out[k] = fourth_root(sums.rayleigh[k] + sums.multiple[k] / phase);
            out[3 + k] = fourth_root(sums.mie[k]);
          }
        }
    });
  }
}

AirLight Air::seen(bool limb, double u, double mu_sun, double cosine_azimuth, double cosine) const {
  const Node row = node_at(u, kRows[limb]);
  const Node sun = node_at(sun_place(mu_sun), kSuns);
  const Node turn = node_at(0.5 * (1 - cosine_azimuth), kAzimuths);
  double values[kValues] = {};
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::size_t a = corner & 1, b = corner >> 1 & 1, c = corner >> 2;
    const double weight = (c ? row.next : 1 - row.next) * (b ? sun.next : 1 - sun.next) *
                          (a ? turn.next : 1 - turn.next);
    const std::size_t at = ((row.first + c) * kSuns + sun.first + b) * kAzimuths + turn.first + a;
    const float* from = &seen_[limb][kValues * at];
    for (std::size_t k = 0; k < kValues; ++k) values[k] += weight * from[k];
  }
  for (double& value : values) value = value * value * value * value;
  AirLight result;
  const double rayleigh = rayleigh_phase(cosine), mie = mie_phase(cosine);
  for (int k = 0; k < 3; ++k) result.light[k] = rayleigh * values[k] + mie * values[3 + k];
  return result;
}

AirLight Air::from_outside(const Vec3& origin, const Vec3& ray, const Vec3& to_sun) const {
  const double lowest = -glm::dot(origin, ray);
  const Vec3 moment = glm::cross(origin, ray);
  const double square = glm::dot(moment, moment);
  if (!(square < top_ * top_ && lowest > 0)) return {};
  const double beside = std::sqrt(square);
  const bool limb = beside >= 1;
  const double mu = limb ? 0 : std::sqrt((1 - beside) * (1 + beside));
  // the foot of the centre on the ray, without its large part along the ray
  const Vec3 foot = glm::cross(ray, moment);
  const Vec3 up = limb ? foot / beside : foot - mu * ray;
  const double mu_sun = glm::dot(up, to_sun), cosine = glm::dot(ray, to_sun);
  const double across = std::sqrt(std::max(0.0, (1 - mu * mu) * (1 - mu_sun * mu_sun)));
  const double azimuth =
      across > 1e-9 ? std::clamp((cosine + mu * mu_sun) / across, -1.0, 1.0) : 0.0;
  const double u = limb ? std::sqrt((beside - 1) / (top_ - 1)) : std::sqrt(mu);
  AirLight result = seen(limb, u, mu_sun, azimuth, cosine);
  result.through = transmittance(limb ? beside : 1, mu);
  if (limb) result.through *= result.through;
  return result;
}

// Over all directions of rays and of the Sun; the ground's with its light from the whole sky.
void Air::fill_albedo() {
  constexpr int kPlaces = 48, kHeightsOfSun = 96, kTurns = 8;
  Vec3 sum(0);
  for (int limb = 0; limb < 2; ++limb)
    for (int i = 0; i < kPlaces; ++i) {
      const double u = (i + 0.5) / kPlaces, width = 2 * u / kPlaces;
      const double r = limb ? 1 + (top_ - 1) * u * u : 1;
      const double mu = limb ? 0 : u * u;
      // of the disc's area
      const double area = limb ? 2 * r * (top_ - 1) * width : 2 * mu * width;
      for (int j = 0; j < kHeightsOfSun; ++j) {
        const double mu_sun = kLowest + (1 - kLowest) * (j + 0.5) / kHeightsOfSun;
        for (int k = 0; k < kTurns; ++k) {
          const double azimuth = det::cos(kPi * (k + 0.5) / kTurns);
          const Look at = look(r, mu, mu_sun, azimuth, top_);
          const AirLight light = seen(limb, u, mu_sun, azimuth, glm::dot(at.ray, at.sun));
          sum += light.light * (area * 2 * kPi * (1 - kLowest) / (kHeightsOfSun * kTurns));
        }
      }
    }
  albedo_ = sum;
  Vec3 down(0), up(0);
  constexpr int kSteps = 256;
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) / kSteps;
    down += ground(kLowest + (1 - kLowest) * t) * (2 * (1 - kLowest) / kSteps);
    up += upward(t) * (2 * t / kSteps);
  }
  ground_factor_ = down * up;
}

}  // namespace panwright::light
