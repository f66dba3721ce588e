#include "preview/reference/internal/trace_lamps.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "preview/reference/internal/sampling.h"
#include "trace/placement.h"

namespace panwright::preview::reference {
namespace {

template <class... Kinds>
struct ByKind : Kinds... {
  using Kinds::operator()...;
};
template <class... Kinds>
ByKind(Kinds...) -> ByKind<Kinds...>;

Vec3 turned(const trace::Affine& to, const Vec3& direction) {
  const Vec3 there = to.linear * direction;
  const double length = glm::length(there);
  return length > 0 ? there / length : glm::normalize(direction);
}

}  // namespace

TraceLamp::TraceLamp(const light::Source& source, const trace::Affine& to) {
  std::visit(ByKind{[&](const light::Sun& one) {
                      light::Sun there = one;
                      there.direction = turned(to, one.direction);
                      distant_.emplace(there, Mat3(1), true);
                    },
                    [&](const light::Point& one) {
                      place_ = to(one.position);
                      radius_ = one.radius;
                      intensity_ = one.intensity;
                    },
                    [&](const light::Disc& one) {
                      place_ = to(one.position);
                      axis_ = turned(to, one.axis);
                      radius_ = one.radius;
                      intensity_ = one.intensity;
                      disc_ = true;
                    },
                    [&](const light::Spot& one) {
                      place_ = to(one.position);
                      axis_ = turned(to, one.axis);
                      radius_ = one.radius;
                      intensity_ = one.intensity;
                      exponent_ = one.exponent;
                      if (one.half_angle < kPi) least_cosine_ = std::cos(one.half_angle);
                    }},
             source);
}

double TraceLamp::share(const Vec3& from_lamp) const {
  if (axis_ == Vec3(0)) return 1;
  const double cosine = glm::dot(axis_, from_lamp);
  if (cosine < least_cosine_) return 0;
  return exponent_ > 0 ? std::pow(std::clamp(cosine, 0.0, 1.0), exponent_) : 1;
}

TraceLamp::Sample TraceLamp::sample(const Vec3& from, const Vec2& u) const {
  if (distant_) {
    const Sun::Sample light = distant_->sample(u);
    return {light.to_light, 1e30, light.irradiance};
  }
  if (disc_) {
    const Frame frame = frame_about(axis_);
    const Vec2 on = radius_ * on_disc(u);
    const Vec3 toward = place_ + on.x * frame.x + on.y * frame.y - from;
    const double distance = glm::length(toward);
    const double cosine = -glm::dot(axis_, toward);
    if (!(cosine > 0)) return {};
    return {toward / distance, distance, intensity_ * (cosine / distance / (distance * distance))};
  }
  const Vec3 toward = place_ - from;
  const double distance = glm::length(toward);
  if (!(distance > 0)) {
    const double facing = radius_ > 0 ? share(Vec3(0, 0, -1)) / (radius_ * radius_) : 0;
    return {Vec3(0, 0, 1), 0, intensity_ * facing};
  }
  const Vec3 middle = toward / distance;
  const Vec3 intensity = intensity_ * share(-middle);
  if (!(radius_ > 0) || distance <= radius_) {
    const double nearest = std::max(distance, radius_);
    return {middle, distance, intensity / (nearest * nearest)};
  }
  // even over the cone
  const double square = radius_ / distance * (radius_ / distance);
  const double height = square / (1 + std::sqrt(1 - square));  // 1 - cos of its half-angle
  const double down = u.x * height;
  const double sine = std::sqrt(down * (2 - down));
  const double angle = 2 * kPi * u.y;
  const Frame frame = frame_about(middle);
  const Vec3 direction =
      sine * (std::cos(angle) * frame.x + std::sin(angle) * frame.y) + (1 - down) * middle;
  const double inside = std::max(square - sine * sine, 0.0);
  return {direction, distance * (1 - down - std::sqrt(inside)),
          intensity * (2 * height / (radius_ * radius_))};
}

TraceLamp::Sample TraceLamp::seen(const Vec3& from, const Vec3& direction) const {
  if (distant_)
    return {direction, 1e30, distant_->has_disc() ? distant_->radiance(direction) : Vec3(0)};
  if (!(radius_ > 0)) return {};
  const Vec3 toward = place_ - from;
  const Vec3 radiance = intensity_ / (kPi * radius_ * radius_);
  if (disc_) {
    const double facing = -glm::dot(axis_, direction);
    const double along = -glm::dot(axis_, toward) / facing;
    if (!(facing > 0) || !(along > 0) || !(glm::length(along * direction - toward) <= radius_))
      return {};
    return {direction, along, radiance};
  }
  const double along = glm::dot(toward, direction);
  const Vec3 off = toward - along * direction;
  const double left = radius_ * radius_ - glm::dot(off, off);
  const double distance = glm::length(toward);
  if (!(left >= 0) || !(along > 0) || !(distance > radius_)) return {};
  return {direction, along - std::sqrt(left), radiance * share(-toward / distance)};
}

TraceLamps trace_lamps(const world::World& world, const world::Camera& camera,
                       const trace::Scene& scene) {
  TraceLamps all(world.size());
  const trace::RigidFrame observer = trace::frame_of({camera.position, camera.world_from_camera});
  for (const world::Lamp& lamp : world.lamps()) {
    if (!lamp.on) continue;
    trace::RigidFrame carrier;
    trace::Affine carrier_from_lamp;
    if (lamp.carrier == world::Lamp::Carrier::camera) carrier = observer;
    if (lamp.carrier == world::Lamp::Carrier::node) {
      const auto target = world.find(lamp.target);
      if (!target || !world[*target].visible()) continue;
      const trace::PlacedNodes nodes = trace::placed_nodes(world[*target]);
      if (lamp.node >= nodes.visible.size() || nodes.visible[lamp.node] == 0) continue;
      carrier = scene.targets()[*target].frame;
      carrier_from_lamp = nodes.model_from_node[lamp.node];
    }
    for (std::size_t i = 0; i < world.size(); ++i)
      all[i].emplace_back(lamp.source,
                          trace::between(scene.targets()[i].frame, carrier) * carrier_from_lamp);
  }
  return all;
}

}  // namespace panwright::preview::reference
