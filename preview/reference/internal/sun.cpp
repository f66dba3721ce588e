#include "preview/reference/internal/sun.h"

#include <algorithm>
#include <cmath>

#include "preview/reference/internal/sampling.h"

namespace panwright::preview::reference {
Sun::Sun(const world::Sun& sun, const Mat3& world_from_model, bool disc)
    : irradiance_(sun.irradiance.value_or(Vec3(1))), darkening_(sun.limb_darkening) {
  const Vec3 to_sun = sun.direction;
  const double largest = std::max({std::fabs(to_sun.x), std::fabs(to_sun.y), std::fabs(to_sun.z)});
  // a row times a rotation: its inverse
  centre_ = glm::normalize((to_sun / largest) * world_from_model);
  const Frame frame = frame_about(centre_);
  across_[0] = frame.x;
  across_[1] = frame.y;
  // closer than its radius the Sun would be more than half the sky
  if (disc) sine_ = std::min(world::kSunSineAtOneAu / sun.distance, 0.999);
}

double Sun::brightness(double square) const {
  const double mu = std::sqrt(std::max(0.0, 1 - square));
  return (1 - darkening_ * (1 - mu)) / (1 - darkening_ / 3);
}

Sun::Sample Sun::sample(const Vec2& u) const {
  if (!has_disc()) return {centre_, irradiance_};
  // even on the disc's projection, where what a facing plane gets is even
  return at(on_disc(u));
}

Sun::Sample Sun::at(const Vec2& place) const {
  const Vec2 offset = sine_ * place;
  const double cosine = std::sqrt(1 - glm::dot(offset, offset));
  const Vec3 direction = offset.x * across_[0] + offset.y * across_[1] + cosine * centre_;
  return {direction, irradiance_ * (brightness(glm::dot(place, place)) / cosine)};
}

Vec2 Sun::place(const Vec3& direction) const {
  if (!(glm::dot(direction, centre_) > 0)) return Vec2(2);
  return Vec2(glm::dot(direction, across_[0]), glm::dot(direction, across_[1])) / sine_;
}

Vec3 Sun::radiance(const Vec3& direction) const {
  const Vec2 offset(glm::dot(direction, across_[0]), glm::dot(direction, across_[1]));
  const double square = glm::dot(offset, offset) / (sine_ * sine_);
  if (!(square <= 1) || !(glm::dot(direction, centre_) > 0)) return Vec3(0);
  return irradiance_ * (brightness(square) / (kPi * sine_ * sine_));
}

}  // namespace panwright::preview::reference
