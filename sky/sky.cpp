#include "sky/sky.h"

#include <algorithm>
#include <cmath>

#include "light/light.h"

namespace panwright::sky {

Ellipsoid::Ellipsoid(const light::Body& body)
    : centre(body.centre),
      volume(body.radii.x * body.radii.y * body.radii.z),
      radius(det::pow(volume, 1.0 / 3)) {
  const Mat3 turn = glm::mat3_cast(glm::normalize(body.world_from_body));
  for (int k = 0; k < 3; ++k) {
    world_from_unit[k] = turn[k] * body.radii[k];
    world_from_normal[k] = turn[k] / body.radii[k];
  }
  unit_from_world = glm::transpose(world_from_normal);
}

Sky::Sky(const world::World& world)
    : bodies_(world.bodies().begin(), world.bodies().end()), sun_visible_(world.sun_visible()) {
  for (const light::Body& body : bodies_) shapes_.emplace_back(body);
  const world::Sun& sun = world.sun();
  to_sun_ = sun.direction / max_component(glm::abs(sun.direction));
  to_sun_ /= std::sqrt(glm::dot(to_sun_, to_sun_));
  const Vec3 other = std::fabs(to_sun_.z) < 0.5 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  across_[0] = glm::normalize(glm::cross(to_sun_, other));
  across_[1] = glm::cross(to_sun_, across_[0]);
  irradiance_ = sun.irradiance.value_or(Vec3(1));
  if (!sun.irradiance) unit_ = light::kSolarIrradiance;
  sun_sine_ = std::min(world::kSunSineAtOneAu / sun.distance, 0.999);
  limb_ = sun.limb_darkening;
  for (std::size_t i = 0; i < size(); ++i) {
    airs_.push_back(light::air_of(bodies_[i]));
    suns_.push_back(glm::normalize(shapes_[i].unit_from_world * to_sun_));
  }
}

Vec3 Sky::radiance(std::size_t index, const Vec3& place, const Vec3& to_viewer, double footprint,
                   const Vec3* viewer) const {
  const Ellipsoid& shape = shapes_[index];
  const light::Body& body = bodies_[index];
  Vec3 through(1), result(0);
  double mu_sun = 0;
  if (const light::Air* air = airs_[index].get()) {
    const Vec3 ray = glm::normalize(shape.unit_from_world * -to_viewer);
    const Vec3& sun = suns_[index];
    const Vec3 from = viewer ? *viewer : place - 2 * air->top() * ray;
    const light::AirLight between = air->light(from, ray, sun);
    through = between.through;
    mu_sun = glm::dot(place, sun);
    result = light::reflected_through(body, *air, body.radii * place, footprint, mu_sun,
                                      -glm::dot(place, ray), between, irradiance_);
  } else {
    const Vec3 normal = glm::normalize(shape.world_from_normal * place);
    mu_sun = glm::dot(normal, to_sun_);
    if (mu_sun > 0)
      result = light::reflected(body, body.radii * place, footprint, normal, to_sun_, to_viewer,
                                irradiance_);
  }
  if (size() > 1 && result != Vec3(0)) result *= sun_share(shape.world(place), index);
  if (body.night)
    result += through * light::night_light(body, body.radii * place, footprint, mu_sun) / unit_;
  return result;
}

light::AirLight Sky::air_light(std::size_t index, const Vec3& viewer, const Vec3& ray) const {
  const light::Air& air = *airs_[index];
  const Ellipsoid& shape = shapes_[index];
  const Vec3 along = glm::normalize(shape.unit_from_world * ray);
  light::AirLight result = air.light(viewer, along, suns_[index]);
  result.light *= irradiance_;
  if (size() > 1 && result.light != Vec3(0)) {
    const Vec3 lowest = viewer + along * std::max(0.0, -glm::dot(viewer, along));
    result.light *= sun_share(shape.world(lowest), index);
  }
  return result;
}

bool Sky::sun_hidden(const Vec3& point) const {
  return std::ranges::any_of(shapes_, [&](const Ellipsoid& shape) {
    const Vec3 from = shape.from(point), ray = shape.unit_from_world * to_sun_;
    if (glm::dot(from, from) < 1) return true;
    const Vec3 moment = glm::cross(from, ray);
    return glm::dot(from, ray) < 0 && glm::dot(moment, moment) < glm::dot(ray, ray);
  });
}

Vec3 Sky::sun_radiance(double square) const {
  const double mu = std::sqrt(std::max(0.0, 1 - square));
  return irradiance_ * ((1 - limb_ * (1 - mu)) / (1 - limb_ / 3) / (kPi * sun_sine_ * sun_sine_));
}

}  // namespace panwright::sky
