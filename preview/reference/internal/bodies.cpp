#include "preview/reference/internal/bodies.h"

#include <algorithm>
#include <cmath>

#include "preview/reference/internal/sampling.h"

namespace panwright::preview::reference {
namespace {

// Nearest way to the unit sphere along a direction of any length, in units of it; none: a miss, or
// the sphere lies behind.
std::optional<double> way_to_sphere(const Vec3& from, const Vec3& direction) {
  const double a = glm::dot(direction, direction);
  const double b = glm::dot(from, direction);
  if (!(b < 0)) return std::nullopt;
  const double distance = glm::length(from);
  const double c = (distance - 1) * (distance + 1);
  const double discriminant = b * b - a * c;
  if (!(c >= 0 && discriminant > 0)) return std::nullopt;
  return c / (-b + std::sqrt(discriminant));
}

// 1 − cos of the angular radius of the unit sphere.
double disc_height(double distance) {
  const double square = distance * distance;
  return 1 / (square * (1 + std::sqrt((distance - 1) * (distance + 1)) / distance));
}

}  // namespace

Bodies::Bodies(std::span<const light::Body> bodies, const trace::RigidFrame& frame, const Sun& sun)
    : sun_(sun) {
  for (const light::Body& body : bodies) {
    const trace::RigidFrame own = trace::frame_of({body.centre, body.world_from_body});
    Placed placed{&body, (own.position - frame.position) * frame.world_from,
                  glm::transpose(frame.world_from) * own.world_from,
                  body.radii.x * body.radii.y * body.radii.z};
    bodies_.push_back(placed);
  }
}

bool Bodies::hides(const Vec3& origin, const Vec3& direction) const {
  return std::ranges::any_of(bodies_, [&](const Placed& one) {
    const Vec3 from = one.to_unit(origin - one.centre);
    return glm::dot(from, from) < 1 || way_to_sphere(from, one.to_unit(direction)).has_value();
  });
}

std::optional<Bodies::Hit> Bodies::nearest(const Vec3& origin, const Vec3& direction) const {
  std::optional<Hit> found;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Placed& one = bodies_[i];
    const Vec3 from = one.to_unit(origin - one.centre), along = one.to_unit(direction);
    const auto way = way_to_sphere(from, along);
    if (way && (!found || *way < found->distance))
      found = Hit{i, *way, glm::normalize(from + *way * along)};
  }
  return found;
}

Vec3 Bodies::radiance(const Vec3& direction, const Hit& hit, const Vec2& u) const {
  const Placed& one = bodies_[hit.body];
  const Vec3 normal = glm::normalize(one.turn * (hit.place / one.body->radii));
  const Vec3 to_sun = sun_.centre();
  if (!(glm::dot(normal, to_sun) > 0)) return Vec3(0);
  if (bodies_.size() > 1) {
    const Vec3 at = one.centre + one.from_unit(hit.place), ray = sun_.sample(u).to_light;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (i == hit.body) continue;
      const Placed& other = bodies_[i];
      if (way_to_sphere(other.to_unit(at - other.centre), other.to_unit(ray))) return Vec3(0);
    }
  }
  return light::reflected(*one.body, hit.place * one.body->radii, 0, normal, to_sun, -direction,
                          sun_.irradiance());
}

double Bodies::disc_of(const Placed& one, const Vec3& origin) {
  const double distance = glm::length(one.to_unit(origin - one.centre));
  return distance > 1 ? disc_height(distance) : 0;
}

std::optional<Bodies::Sample> Bodies::sample(const Vec3& origin, const Vec2& u,
                                             double u_body) const {
  double all = 0;
  for (const Placed& one : bodies_) all += disc_of(one, origin);
  if (!(all > 0)) return std::nullopt;
  const Placed* chosen = nullptr;
  double before = 0;
  for (const Placed& one : bodies_) {
    const double share = disc_of(one, origin);
    if (!(share > 0)) continue;
    chosen = &one;
    before += share;
    if (u_body * all < before) break;
  }
  const Vec3 from = chosen->to_unit(origin - chosen->centre);
  const double distance = glm::length(from);
  const Vec3 axis = -from / distance;
  const Frame frame = frame_about(axis);
  const Vec2 disc = on_disc(u);
  const double h = disc_height(distance) * glm::dot(disc, disc);
  const double scale = std::sqrt(disc_height(distance) * (2 - h));
  const Vec3 ray = (1 - h) * axis + scale * (disc.x * frame.x + disc.y * frame.y);
  Sample sample;
  sample.direction = glm::normalize(chosen->from_unit(ray));
  sample.pdf = pdf(origin, sample.direction);
  if (!(sample.pdf > 0)) return std::nullopt;
  return sample;
}

// Even over directions ω of the unit sphere's space; those of the frame, S·ω, are denser by
// |S·ω|³/det S.
double Bodies::pdf_of(const Placed& one, const Vec3& origin, const Vec3& direction) const {
  const Vec3 from = one.to_unit(origin - one.centre);
  const double distance = glm::length(from);
  if (!(distance > 1)) return 0;
  const Vec3 along = one.to_unit(direction);
  if (!way_to_sphere(from, along)) return 0;
  const double length = glm::length(along);
  return 1 / (length * length * length * one.volume);
}

double Bodies::pdf(const Vec3& origin, const Vec3& direction) const {
  double all = 0, sum = 0;
  for (const Placed& one : bodies_) {
    const double disc = disc_of(one, origin);
    if (!(disc > 0)) continue;
    all += disc;
    sum += pdf_of(one, origin, direction);
  }
  // a body's share, its disc of all, times the density there, 1/(2 pi disc)
  return all > 0 ? sum / (2 * kPi * all) : 0;
}

}  // namespace panwright::preview::reference
