#include "light/light.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace panwright::light {
namespace {

bool is_radiant(const Vec3& v) { return is_finite(v) && v.x >= 0 && v.y >= 0 && v.z >= 0; }

bool is_size(double radius) { return std::isfinite(radius) && radius >= 0; }

bool is_direction(const Vec3& v) { return is_finite(v) && v != Vec3(0); }

bool holds(const Sun& sun) {
  return is_direction(sun.direction) && std::isfinite(sun.distance) && sun.distance > 0 &&
         is_radiant(sun.irradiance.value_or(Vec3(1))) && sun.limb_darkening >= 0 &&
         sun.limb_darkening <= 1;
}

bool holds(const Spot& spot) {
  return is_finite(spot.position) && is_direction(spot.axis) && is_radiant(spot.intensity) &&
         spot.half_angle > 0 && spot.half_angle <= kPi && is_size(spot.exponent) &&
         is_size(spot.radius);
}

bool holds(const Point& point) {
  return is_finite(point.position) && is_radiant(point.intensity) && is_size(point.radius);
}

bool holds(const Disc& disc) {
  return is_finite(disc.position) && is_direction(disc.axis) && is_radiant(disc.intensity) &&
         std::isfinite(disc.radius) && disc.radius > 0;
}

// Light of a sphere; scale: irradiance times squared distance.
Incidence of_sphere(const Vec3& centre, double radius, const Vec3& scale, const Vec3& point) {
  const Vec3 toward = centre - point;
  const double distance = std::sqrt(glm::dot(toward, toward));
  if (!(distance > 0)) {
    const double square = radius * radius;
    return {Vec3(0, 0, 1), square > 0 ? scale / square : Vec3(0), square > 0 ? 0.125 : 0.0};
  }
  const double nearest = std::max(distance, radius);
  const double sine = radius / nearest;
  return {toward / distance, scale / (nearest * nearest), sine * sine / 8};
}

Incidence from(const Sun& sun, const Vec3&) {
  return {glm::normalize(sun.direction), sun.irradiance.value_or(Vec3(1)),
          materials::kSunAlpha2 / (sun.distance * sun.distance), sun.limb_darkening};
}

Incidence from(const Spot& spot, const Vec3& point) {
  Incidence light = of_sphere(spot.position, spot.radius, spot.intensity, point);
  const Vec3 axis = spot.axis / std::sqrt(glm::dot(spot.axis, spot.axis));
  const double cosine = -glm::dot(axis, light.to_light);
  // a half-angle of π lights all directions, whatever rounding does
  const bool lit = spot.half_angle >= kPi || cosine >= det::cos(spot.half_angle);
  double share = lit ? 1 : 0;
  if (lit && spot.exponent > 0)
    share = cosine > 0 ? det::exp(spot.exponent * det::log(std::min(cosine, 1.0))) : 0;
  light.irradiance *= share;
  return light;
}

Incidence from(const Point& source, const Vec3& point) {
  return of_sphere(source.position, source.radius, source.intensity, point);
}

Incidence from(const Disc& disc, const Vec3& point) {
  const Vec3 toward = disc.position - point;
  const Vec3 axis = disc.axis / std::sqrt(glm::dot(disc.axis, disc.axis));
  const double squared = glm::dot(toward, toward);
  const double square = disc.radius * disc.radius;
  // in its middle: half of the sky
  const double distance = std::sqrt(squared);
  const Vec3 to_light = distance > 0 ? toward / distance : -axis;
  const double cosine = std::max(-glm::dot(axis, to_light), 0.0);
  return {to_light, disc.intensity * (cosine / (squared + square)),
          square / (squared + square) / 8};
}

}  // namespace

bool is_sound(const Source& source) {
  return std::visit([](const auto& one) { return holds(one); }, source);
}

Incidence incidence(const Source& source, const Vec3& point) {
  assert(is_sound(source) && is_finite(point));
  return std::visit([&](const auto& one) { return from(one, point); }, source);
}

bool Light::set(const Source& source) {
  assert(is_sound(source));
  if (source_ == source) return false;
  source_ = source;
  stamp_ = next_stamp();
  return true;
}

}  // namespace panwright::light
