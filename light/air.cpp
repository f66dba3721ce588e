#include "light/air.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <mutex>
#include <utility>

#include "base/parallel.h"

namespace panwright::light {
namespace {

constexpr double kTop = 100e3;  // metres

// B. Bodhaine et al., "On Rayleigh optical depth calculations", 1999: sea level, clear.
const Vec3 kRayleighDepth(0.0492, 0.0973, 0.2225);
constexpr double kRayleighScale = 8e3;  // metres

// Aerosols of the sea, thin. Half of their forward lobe is light that goes straight on.
constexpr double kMieDepth = 0.05, kMieScale = 1200, kMieAlbedo = 0.95, kMieAsymmetry = 0.6;

// 300 Dobson units between 10 and 40 km, most at 25 km. V. Gorshelev, A. Serdyuchenko et al., "High
// spectral resolution ozone absorption cross-sections", 2014.
const Vec3 kOzoneDepth = 300 * 2.687e20 * Vec3(2.24e-25, 3.5e-25, 2.3e-26);
constexpr double kOzoneMiddle = 25e3, kOzoneHalf = 15e3;

// A ray that grazes the ground is bent by twice the horizontal refraction, 35 minutes of arc, as of
// a refractivity that falls exponentially: N·sqrt(2 pi R/H).
constexpr double kRefractivity = 2.81e-4, kRefractivityScale = 7600;

constexpr int kHeights = 48, kAngles = 160;       // of transmittances
constexpr int kManyHeights = 16, kManySuns = 48;  // of multiple scattering
constexpr int kGroundSuns = 96, kViews = 64, kGrazing = 201;
constexpr double kLowestSun = -0.36;  // sine of its height, where the air is dark

// Heights of the Sun, closest to each other at the horizon: 0 to 1.
double place_of_sun(double mu) {
  const auto root = [](double x) { return x < 0 ? -std::sqrt(-x) : std::sqrt(x); };
  const double low = root(kLowestSun);
  return std::clamp((root(mu) - low) / (1 - low), 0.0, 1.0);
}
double sun_at(double place) {
  const double low = -std::sqrt(-kLowestSun);
  const double root = low + place * (1 - low);
  return root * std::fabs(root);
}

Vec3 vec3_at(const std::vector<float>& table, std::size_t i) {
  return {table[3 * i], table[3 * i + 1], table[3 * i + 2]};
}
void put(std::vector<float>& table, std::size_t i, const Vec3& value) {
  for (int k = 0; k < 3; ++k)
    table[3 * i + static_cast<std::size_t>(k)] = static_cast<float>(value[k]);
}

// Node and weight of the next one, of a place 0 to 1 among `count` nodes.
std::pair<std::size_t, double> node_of(double place, int count) {
  const double x = std::clamp(place, 0.0, 1.0) * (count - 1);
  const double node = std::min(std::floor(x), count - 2.0);
  return {static_cast<std::size_t>(node), x - node};
}

Vec3 line(const std::vector<float>& table, int count, double place) {
  const auto [i, a] = node_of(place, count);
  return glm::mix(vec3_at(table, i), vec3_at(table, i + 1), a);
}

Vec3 plane(const std::vector<float>& table, int rows, int columns, double row, double column) {
  const auto [j, b] = node_of(row, rows);
  const auto [i, a] = node_of(column, columns);
  const std::size_t first = j * static_cast<std::size_t>(columns) + i;
  const std::size_t second = first + static_cast<std::size_t>(columns);
  return glm::mix(glm::mix(vec3_at(table, first), vec3_at(table, first + 1), a),
                  glm::mix(vec3_at(table, second), vec3_at(table, second + 1), a), b);
}

Vec3 exp3(const Vec3& x) { return {det::exp(x.x), det::exp(x.y), det::exp(x.z)}; }

// Directions of the Sun and of rays at a place above the centre on z.
Vec3 on_meridian(double mu) { return {std::sqrt(std::max(0.0, 1 - mu * mu)), 0, mu}; }

}  // namespace

Air::Air(double radius) : radius_(radius), top_(1 + kTop / radius) {
  assert(radius >= kLeastRadius);
  fill_transmittance();
  fill_grazing();
  fill_multiple();
  fill_ground();
  fill_seen();
  fill_albedo();
}

Air::Matter Air::matter(double r) const {
  const double height = std::max(0.0, (r - 1) * radius_);
  const double air = det::exp(-height / kRayleighScale) * radius_ / kRayleighScale;
  const double haze = det::exp(-height / kMieScale) * radius_ / kMieScale;
  const double ozone =
      std::max(0.0, 1 - std::fabs(height - kOzoneMiddle) / kOzoneHalf) * radius_ / kOzoneHalf;
  Matter matter;
  matter.rayleigh = kRayleighDepth * air;
  matter.mie = Vec3(kMieDepth * kMieAlbedo * haze);
  matter.extinction = matter.rayleigh + kMieDepth * haze + kOzoneDepth * ozone;
  return matter;
}

double Air::rayleigh_phase(double cosine) { return 3 / (16 * kPi) * (1 + cosine * cosine); }

// W. Cornette, J. Shanks, "Physically reasonable analytic expression for the single-scattering
// phase function", 1992.
double Air::mie_phase(double cosine) {
  constexpr double g = kMieAsymmetry;
  const double lobe = 1 + g * g - 2 * g * cosine;
  return 3 / (8 * kPi) * (1 - g * g) / (2 + g * g) * (1 + cosine * cosine) /
         (lobe * std::sqrt(lobe));
}

// Rows by height, roots of it; columns by the way out of the air between its least and its most, as
// E. Bruneton, F. Neyret, "Precomputed atmospheric scattering", 2008.
Vec3 Air::transmittance(double r, double mu) const {
  r = std::clamp(r, 1.0, top_);
  const double beside = r * r * (1 - mu * mu);
  if (mu < 0 && beside < 1) return Vec3(0);
  const double way = -r * mu + std::sqrt(std::max(0.0, top_ * top_ - beside));
  const double least = top_ - r;
  const double most = std::sqrt((r - 1) * (r + 1)) + std::sqrt((top_ - 1) * (top_ + 1));
  const double column = (way - least) / std::max(most - least, 1e-12);
  return plane(transmittance_, kHeights, kAngles, std::sqrt((r - 1) / (top_ - 1)), column);
}

void Air::fill_transmittance() {
  transmittance_.resize(std::size_t{3} * kHeights * kAngles);
  parallel_for(kHeights, [&](std::size_t row) {
    const double root = static_cast<double>(row) / (kHeights - 1);
    const double r = 1 + (top_ - 1) * root * root;
    const double least = top_ - r;
    const double most = std::sqrt((r - 1) * (r + 1)) + std::sqrt((top_ - 1) * (top_ + 1));
    for (int column = 0; column < kAngles; ++column) {
      const double way = least + (most - least) * column / (kAngles - 1);
      const double mu =
          way > 0 ? std::clamp(((top_ - r) * (top_ + r) - way * way) / (2 * r * way), -1.0, 1.0)
                  : 1;
      // by steps that grow from the lowest place
      const double lowest = std::clamp(-r * mu, 0.0, way);
      Vec3 depth(0);
      const auto add = [&](double length, double from) {
        constexpr int kSteps = 32;
        for (int i = 0; i < kSteps; ++i) {
          const double w = (i + 0.5) / kSteps;
          const double t = from + (length - from) * w * w;
          const double at = std::sqrt(r * r + t * t + 2 * r * mu * t);
          depth += matter(at).extinction * (std::fabs(length - from) * 2 * w / kSteps);
        }
      };
      if (lowest > 0) add(0, lowest);
      if (lowest < way) add(way, lowest);
      put(transmittance_, row * kAngles + static_cast<std::size_t>(column), exp3(-depth));
    }
  });
}

double Air::bending(double r) const {
  return kRefractivity * std::sqrt(2 * kPi * radius_ / kRefractivityScale) *
         det::exp(-(r - 1) * radius_ / kRefractivityScale);
}

Vec3 Air::grazing(double r) const {
  if (r >= top_) return Vec3(1);
  const auto [i, a] = node_of((r - 1) / (top_ - 1), kGrazing);
  return exp3(-glm::mix(grazing_[i], grazing_[i + 1], a));
}

void Air::fill_grazing() {
  constexpr int kSteps = 96;
  grazing_.assign(kGrazing, Vec3(0));
  for (std::size_t i = 0; i + 1 < kGrazing; ++i) {
    const double r = 1 + (top_ - 1) * static_cast<double>(i) / (kGrazing - 1);
    const double step = std::sqrt((top_ - r) * (top_ + r)) / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      const double t = (k + 0.5) * step;
      grazing_[i] += 2 * step * matter(std::sqrt(r * r + t * t)).extinction;
    }
  }
}

Vec3 Air::multiple(double r, double mu_sun) const {
  return plane(multiple_, kManyHeights, kManySuns,
               std::sqrt(std::clamp((r - 1) / (top_ - 1), 0.0, 1.0)), place_of_sun(mu_sun));
}

// All orders after the second are shares of it: S. Hillaire, "A scalable and production ready sky
// and atmosphere rendering technique", 2020.
void Air::fill_multiple() {
  multiple_.assign(std::size_t{3} * kManyHeights * kManySuns, 0);
  std::vector<float> filled = multiple_;
  parallel_for(kManyHeights, [&](std::size_t row) {
    constexpr int kRings = 12, kSectors = 5;
    const double root = static_cast<double>(row) / (kManyHeights - 1);
    const Vec3 origin(0, 0, 1 + (top_ - 1) * std::clamp(root * root, 1e-7, 1 - 1e-7));
    for (int column = 0; column < kManySuns; ++column) {
      const Vec3 sun = on_meridian(sun_at(static_cast<double>(column) / (kManySuns - 1)));
      Vec3 second(0), share(0);
      for (int ring = 0; ring < kRings; ++ring) {
        // more of them at the horizon: mu = x³, by its derivative
        const double x = (2 * ring + 1.0) / kRings - 1, mu = x * x * x;
        const double weight = 3 * x * x * (2.0 / kRings) / (2 * kSectors);
        const double across = std::sqrt(1 - mu * mu);
        for (int sector = 0; sector < kSectors; ++sector) {
          const det::SinCos turn = det::sincos(kPi * (sector + 0.5) / kSectors);
          const Sums sums =
              march(origin, Vec3(across * turn.cos, across * turn.sin, mu), sun, {12, true});
          second += weight * sums.mie;
          share += weight * sums.multiple;
        }
      }
      put(filled, row * kManySuns + static_cast<std::size_t>(column), second / (Vec3(1) - share));
    }
  });
  multiple_ = std::move(filled);
}

void Air::add_segment(const Vec3& origin, const Vec3& ray, const Vec3& to_sun, double low,
                      double high, const Steps& steps, Sums& sums) const {
  const bool falls = low > high;
  for (int i = 0; i < steps.count; ++i) {
    const double w = ((falls ? steps.count - 1 - i : i) + 0.5) / steps.count;
    const double step = std::fabs(high - low) * 2 * w / steps.count;
    const Vec3 place = origin + ray * (low + (high - low) * w * w);
    const double r = std::sqrt(glm::dot(place, place));
    const Matter here = matter(r);
    const Vec3 half = exp3(-0.5 * step * here.extinction);
    const double mu_sun = glm::dot(place, to_sun) / r;
    const Vec3 sun = transmittance(r, mu_sun);
    const Vec3 weight = sums.through * half * step;
    if (steps.isotropic) {
      const Vec3 scattered = weight * (here.rayleigh + here.mie);
      sums.mie += scattered * sun / (4 * kPi);
      sums.multiple += scattered;
    } else {
      sums.rayleigh += weight * here.rayleigh * sun;
      sums.mie += weight * here.mie * sun;
      sums.multiple += weight * (here.rayleigh + here.mie) * multiple(r, mu_sun);
    }
    sums.through *= half * half;
  }
}

Air::Sums Air::march(const Vec3& origin, const Vec3& ray, const Vec3& to_sun,
                     const Steps& steps) const {
  Sums sums;
  const double lowest = -glm::dot(origin, ray);
  const Vec3 moment = glm::cross(origin, ray);
  const double beside = glm::dot(moment, moment);
  if (!(beside < top_ * top_)) return sums;
  const double half = std::sqrt(top_ * top_ - beside);
  const double begin = std::max(0.0, lowest - half);
  double end = lowest + half;
  if (!(end > begin)) return sums;
  if (beside < 1 && lowest > 0) end = std::max(begin, lowest - std::sqrt(1 - beside));
  const Steps one = {steps.count / 2, steps.isotropic};
  if (lowest <= begin) {
    add_segment(origin, ray, to_sun, begin, end, steps, sums);
  } else if (lowest >= end) {
    add_segment(origin, ray, to_sun, end, begin, steps, sums);
  } else {
    add_segment(origin, ray, to_sun, lowest, begin, one, sums);
    add_segment(origin, ray, to_sun, lowest, end, one, sums);
  }
  return sums;
}

AirLight Air::light_of(const Sums& sums, double cosine) const {
  return {rayleigh_phase(cosine) * sums.rayleigh + mie_phase(cosine) * sums.mie + sums.multiple,
          sums.through};
}

AirLight Air::along(const Vec3& origin, const Vec3& ray, const Vec3& to_sun) const {
  return light_of(march(origin, ray, to_sun, {48, false}), glm::dot(ray, to_sun));
}

Vec3 Air::ground(double mu_sun) const { return line(ground_, kGroundSuns, place_of_sun(mu_sun)); }

Vec3 Air::upward(double mu) const {
  return line(upward_, kViews, std::sqrt(std::clamp(mu, 0.0, 1.0)));
}

void Air::fill_ground() {
  ground_.resize(std::size_t{3} * kGroundSuns);
  parallel_for(kGroundSuns, [&](std::size_t i) {
    constexpr int kRings = 10, kSectors = 6;
    const double mu_sun = sun_at(static_cast<double>(i) / (kGroundSuns - 1));
    const Vec3 sun = on_meridian(mu_sun), origin(0, 0, 1);
    Vec3 sum = std::max(0.0, mu_sun) * transmittance(1, std::max(0.0, mu_sun));
    for (int ring = 0; ring < kRings; ++ring) {
      // mu² evenly: the mean of cosines
      const double mu = std::sqrt((ring + 0.5) / kRings), across = std::sqrt(1 - mu * mu);
      for (int sector = 0; sector < kSectors; ++sector) {
        const det::SinCos turn = det::sincos(kPi * (sector + 0.5) / kSectors);
        const Vec3 ray(across * turn.cos, across * turn.sin, mu);
        sum += light_of(march(origin, ray, sun, {24, false}), glm::dot(ray, sun)).light *
               (kPi / (kRings * kSectors));
      }
    }
    put(ground_, i, sum);
  });
  // by reciprocity the light of the ground leaves as light comes to it; at the limb of a sphere a
  // part of the air is lit from below
  constexpr double kLimb = 0.06;
  upward_.resize(std::size_t{3} * kViews);
  for (std::size_t i = 0; i < kViews; ++i) {
    const double root = static_cast<double>(i) / (kViews - 1), mu = root * root;
    const Vec3 direct = transmittance(1, mu);
    const Vec3 scattered = (ground(mu) - mu * direct) / std::max(mu, kLimb);
    put(upward_, i, glm::min(direct + scattered, Vec3(1)));
  }
}

std::shared_ptr<const Air> earth_air(double radius) {
  constexpr std::size_t kKept = 4;
  static std::mutex mutex;
  static std::deque<std::pair<double, std::shared_ptr<const Air>>> kept;
  const std::lock_guard lock(mutex);
  for (const auto& [of, air] : kept)
    if (of == radius) return air;
  if (kept.size() == kKept) kept.pop_front();
  return kept.emplace_back(radius, std::make_shared<const Air>(radius)).second;
}

}  // namespace panwright::light
