#include "preview/reference/internal/bodies.h"

#include <algorithm>
#include <cmath>

#include "light/light.h"
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

Bodies::Bodies(std::span<const light::Body> bodies, const trace::RigidFrame& frame, const Sun& sun,
               const Vec3& unit)
    : sun_(sun), unit_(unit) {
  for (const light::Body& body : bodies) {
    const trace::RigidFrame own = trace::frame_of({body.centre, body.world_from_body});
    Placed placed{&body, (own.position - frame.position) * frame.world_from,
                  glm::transpose(frame.world_from) * own.world_from,
                  body.radii.x * body.radii.y * body.radii.z, light::air_of(body)};
    bodies_.push_back(placed);
  }
}

// Around the ring of a body's air, from outside: light that is not bent would come at the angle s
// from the centre; it is seen at angles a, where a − bending(a) is s, or −s on the other side, and
// spread by how these change.
Vec3 Bodies::through_ring(const Placed& one, const Vec3& from, const Vec3& ray) {
  const light::Air& air = *one.air;
  const double distance = glm::length(from);
  const double sine = glm::length(glm::cross(from, ray)) / distance;
  const double straight = std::atan2(sine, -glm::dot(from, ray) / distance);
  const auto source = [&](double r) { return std::asin(r / distance) - air.bending(r); };
  if (straight >= source(air.top())) return Vec3(1);
  Vec3 sum(0);
  for (const double side : {1.0, -1.0}) {
    const double want = side * straight;
    if (want < source(1)) continue;
    double low = 1, high = air.top();
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (source(middle) < want ? low : high) = middle;
    }
    constexpr double kStep = 1e-7;
    const double turned = std::asin((low + kStep) / distance) - std::asin(low / distance);
    const double change = source(low + kStep) - source(low);
    sum += air.grazing(low) * (turned / change * (low / distance) / std::max(sine, 1e-12));
  }
  return sum;
}

Vec3 Bodies::passes(const Vec3& origin, const Vec3& direction) const {
  Vec3 share(1);
  for (const Placed& one : bodies_) {
    const Vec3 from = one.to_unit(origin - one.centre), along = one.to_unit(direction);
    const double distance = glm::length(from);
    if (one.body->sunset && distance > one.air->top() && glm::dot(from, along) < 0)
      share *= through_ring(one, from, glm::normalize(along));
    else if (distance < 1 || way_to_sphere(from, along))
      return Vec3(0);
  }
  return share;
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

bool Bodies::eclipsed(std::size_t body, const Vec3& at, const Vec2& u) const {
  if (bodies_.size() < 2) return false;
  const Vec3 ray = sun_.sample(u).to_light;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Placed& other = bodies_[i];
    if (i != body && way_to_sphere(other.to_unit(at - other.centre), other.to_unit(ray)))
      return true;
  }
  return false;
}

Vec3 Bodies::radiance(const Vec3& origin, const Vec3& direction, const Hit& hit,
                      const Vec2& u) const {
  const Placed& one = bodies_[hit.body];
  const Vec3 to_sun = sun_.centre(), at = one.centre + one.from_unit(hit.place);
  const light::Body& body = *one.body;
  const Vec3 place = hit.place * body.radii;
  Vec3 through(1), result(0);
  double mu_sun = 0;
  if (one.air) {
    const Vec3 ray = glm::normalize(one.to_unit(direction));
    const Vec3 sun = glm::normalize(one.to_unit(to_sun));
    const light::AirLight between = one.air->light(one.to_unit(origin - one.centre), ray, sun);
    through = between.through;
    mu_sun = glm::dot(hit.place, sun);
    result = light::reflected_through(body, *one.air, place, 0, mu_sun, -glm::dot(hit.place, ray),
                                      between, sun_.irradiance());
  } else {
    const Vec3 normal = glm::normalize(one.turn * (hit.place / body.radii));
    mu_sun = glm::dot(normal, to_sun);
    if (mu_sun > 0)
      result = light::reflected(body, place, 0, normal, to_sun, -direction, sun_.irradiance());
  }
  if (!(result == Vec3(0)) && eclipsed(hit.body, at, u)) result = Vec3(0);
  if (body.night) result += through * light::night_light(body, place, 0, mu_sun) / unit_;
  return result;
}

Vec3 Bodies::light(const Vec3& origin, const Vec3& direction, const Vec2& u,
                   const Vec3& behind) const {
  const auto hit = nearest(origin, direction);
  Vec3 result = hit ? radiance(origin, direction, *hit, u) : behind;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Placed& one = bodies_[i];
    if (!one.air || (hit && hit->body == i)) continue;
    const Vec3 from = one.to_unit(origin - one.centre);
    const Vec3 along = one.to_unit(direction), ray = glm::normalize(along);
    const Vec3 moment = glm::cross(from, ray);
    const double top = one.air->top(), lowest = std::max(0.0, -glm::dot(from, ray));
    // beside the ground: past the air, or behind what is in front of it
    if (glm::dot(moment, moment) >= top * top || (lowest == 0 && glm::length(from) >= top))
      continue;
    if (hit && hit->distance * glm::length(along) < lowest) continue;
    const light::AirLight air =
        one.air->light(from, ray, glm::normalize(one.to_unit(sun_.centre())));
    result *= air.through;
    if (!eclipsed(i, one.centre + one.from_unit(from + lowest * ray), u))
      result += air.light * sun_.irradiance();
  }
  return result;
}

Vec3 Bodies::sampled_from(const Placed& one, const Vec3& origin) {
  const Vec3 from = one.to_unit(origin - one.centre);
  return one.air && glm::length(from) > one.air->top() ? from / one.air->top() : from;
}

double Bodies::disc_of(const Placed& one, const Vec3& origin) {
  const double distance = glm::length(sampled_from(one, origin));
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
  const Vec3 from = sampled_from(*chosen, origin);
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
  const Vec3 from = sampled_from(one, origin);
  const double distance = glm::length(from);
  if (!(distance > 1)) return 0;
  const Vec3 along = one.to_unit(direction);
  if (!way_to_sphere(from, along)) return 0;
  const double length = glm::length(along);
  return 1 / (length * length * length * one.volume);
}

Vec3 radiance_unit(const world::World& world) {
  return world.sun().irradiance ? Vec3(1) : light::kSolarIrradiance;
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
