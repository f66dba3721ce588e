#include "preview/frame/lamps.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <type_traits>
#include <variant>

#include "base/text.h"
#include "preview/frame/blocks.h"

namespace panwright::preview {
namespace {

constexpr double kShadowShare = 1e-3;  // of the lamps' irradiance
constexpr double kShadowShareOfSun = 1e-6;
constexpr double kWidestMap = 2.2;  // tangent: 65.5 degrees
constexpr unsigned kMostLampPoints = 16;

struct Sphere {
  Vec3 centre{0};
  double radius = 0;
};

Sphere sphere_of(const world::Instance& target, const AxisBox& box) {
  const world::Pose& pose = target.pose();
  return {pose.translation + pose.rotation * (0.5 * (box.low + box.high)),
          0.5 * glm::length(box.high - box.low)};
}

Sphere sphere_of(const FrameScene& scene, std::size_t receiver) {
  return sphere_of(scene.world[scene.visible.targets[receiver].target],
                   *scene.state(receiver).bounds);
}

// What all kinds but discs at infinity have.
struct Emitter {
  Vec3 position{0};
  Vec3 axis{0};  // unit; 0: all directions
  double half_angle = kPi;
  double exponent = 0;
  double radius = 0;
  Vec3 intensity{0};
  bool disc = false;
};

std::optional<Emitter> emitter_of(const light::Source& source) {
  return std::visit(
      [](const auto& one) -> std::optional<Emitter> {
        using Kind = std::decay_t<decltype(one)>;
        if constexpr (std::is_same_v<Kind, light::Sun>) {
          return std::nullopt;
        } else {
          Emitter emitter{
              .position = one.position, .radius = one.radius, .intensity = one.intensity};
          if constexpr (std::is_same_v<Kind, light::Spot>) {
            emitter.axis = glm::normalize(one.axis);
            emitter.half_angle =
                one.exponent > 0 ? std::min(one.half_angle, kPi / 2) : one.half_angle;
            emitter.exponent = one.exponent;
          } else if constexpr (std::is_same_v<Kind, light::Disc>) {
            emitter.axis = glm::normalize(one.axis);
            emitter.half_angle = kPi / 2;
            emitter.exponent = 1;
            emitter.disc = true;
          }
          return emitter;
        }
      },
      source);
}

// The irradiance of a source anywhere in a sphere, at most, in its strongest band.
double most_irradiance(const light::Source& source, const Sphere& sphere) {
  const std::optional<Emitter> emitter = emitter_of(source);
  if (!emitter) return max_component(std::get<light::Sun>(source).irradiance.value_or(Vec3(1)));
  const Vec3 toward = sphere.centre - emitter->position;
  const double distance = glm::length(toward);
  const double intensity = max_component(emitter->intensity);
  // within the sphere: as at a quarter of it, so that others count beside
  const double nearest =
      std::max({distance - sphere.radius, 0.25 * sphere.radius, emitter->radius, 1e-150});
  const double irradiance = intensity / nearest / nearest;
  if (emitter->half_angle >= kPi || !(distance > sphere.radius)) return irradiance;
  const double angle = std::acos(std::clamp(glm::dot(toward, emitter->axis) / distance, -1.0, 1.0));
  const double reach = std::asin(sphere.radius / distance) + emitter->half_angle + 1e-6;
  return angle > reach ? 0 : irradiance;
}

// The tangent of the widest angle from an axis to a corner of a box; infinite: 90 degrees or more.
double widest_tangent(const Vec3& from, const Vec3& axis, const Mat4& world_from_model,
                      const AxisBox& box) {
  double widest = 0;
  for (const Vec3& corner : corners(box.low, box.high)) {
    const Vec3 toward = Vec3(world_from_model * Vec4(corner, 1)) - from;
    const double along = glm::dot(toward, axis);
    if (!(along > 0)) return INFINITY;
    widest = std::max(widest, glm::length(toward - along * axis) / along);
  }
  return widest;
}

// Distance of the nearest visible part of a receiver in front of the camera, metres.
double nearest_depth(const FrameScene& scene, std::size_t r) {
  double nearest = INFINITY;
  for (const PlacedBox& part : scene.visible.targets[r].boxes)
    for (const Vec3& corner : corners(part.low, part.high))
      nearest = std::min(nearest, (part.camera_from_mesh * Vec4(corner, 1)).z);
  return nearest;
}

// Whether a lamp is at the camera, which sees no shadow of it.
bool is_at_camera(const light::Source& source, const FrameScene& scene, std::size_t r) {
  const std::optional<Emitter> emitter = emitter_of(source);
  const double seen = nearest_depth(scene, r);
  return emitter && scene.camera.projection == world::Projection::perspective && seen > 0 &&
         glm::length(emitter->position - scene.camera.position) * scene.camera.focal.x < 0.5 * seen;
}

// The maps of places on a lamp on a receiver, of each place one, or six all around.
//
//   places  on its disc, as parts of its radius
std::vector<LampMap> maps_of(const light::Source& source, std::span<const Vec2> places,
                             const FrameScene& scene, std::size_t r) {
  const Sphere sphere = sphere_of(scene, r);
  const std::optional<Emitter> emitter = emitter_of(source);
  if (!emitter) {
    const Vec3 to_light = glm::normalize(std::get<light::Sun>(source).direction);
    return {parallel_map(sphere.centre, sphere.radius, to_light, 0)};
  }
  const Vec3 toward = sphere.centre - emitter->position;
  const double distance = glm::length(toward);
  const Vec3 axis = distance > 0 ? toward / distance : Vec3(0, 0, 1);
  const Mat4 pose = scene.world[scene.visible.targets[r].target].pose().matrix();
  const AxisBox& box = *scene.state(r).bounds;
  // from beside its middle the cone is a little wider
  const double nearest = std::max(distance - sphere.radius, emitter->radius);
  const double beside = places.size() > 1 ? emitter->radius / nearest : 0;
  const double of_cone =
      emitter->half_angle < 1.5 ? std::tan(emitter->half_angle) + beside : double{INFINITY};
  double of_box = 0;
  std::vector<Vec3> eyes;
  const Mat3 across = glm::mat3_cast(looking_along(emitter->disc ? emitter->axis : axis));
  for (const Vec2& place : places) {
    eyes.push_back(emitter->position +
                   emitter->radius * (place.x * across[0] + place.y * across[1]));
    of_box = std::max(of_box, widest_tangent(eyes.back(), axis, pose, box));
  }
  const bool whole = std::min(of_box, of_cone) > kWidestMap;
  const bool by_cone = of_cone < of_box;
  std::vector<LampMap> maps;
  for (const Vec3& eye : eyes) {
    LampMap map;
    map.camera.position = eye;
    map.nearest = emitter->radius;
    map.camera.world_from_camera = looking_along(by_cone ? emitter->axis : axis);
    if (!whole) map.extent = std::max(by_cone ? of_cone : of_box, 1e-12);
    // as a cube (shaders/shadow.glsl)
    for (int face = 0; face < (whole ? 6 : 1); ++face) {
      Vec3 out(0);
      out[face / 2] = face % 2 == 0 ? 1 : -1;
      if (whole) map.camera.world_from_camera = looking_along(out);
      maps.push_back(map);
    }
  }
  return maps;
}

}  // namespace

void Lamps::begin_scene(const FrameScene& scene, const SunDisc& softness) {
  softness_ = softness;
  any_ = false;
  points_ = true;
  left_out_ = 0;
  receivers_.assign(scene.visible.targets.size(), {});
  if (sources_.empty()) return;
  for (std::size_t r = 0; r < receivers_.size(); ++r) {
    std::vector<Lamp>& lamps = receivers_[r].lamps;
    const Sphere sphere = sphere_of(scene, r);
    for (const light::Source& source : sources_)
      if (const double irradiance = most_irradiance(source, sphere); irradiance > 0)
        lamps.push_back({source, irradiance, 0, 0});
    if (lamps.size() > kMostLamps) {
      left_out_ = std::max(left_out_, static_cast<unsigned>(lamps.size() - kMostLamps));
      std::ranges::stable_sort(lamps, std::greater{}, &Lamp::irradiance);
      lamps.resize(kMostLamps);
    }
    any_ = any_ || !lamps.empty();
    for (const Lamp& lamp : lamps) {
      const std::optional<Emitter> emitter = emitter_of(lamp.source);
      points_ = points_ && emitter && emitter->radius == 0;
    }
  }
}

// Points of a lamp's disc whose shadows make its penumbra on a receiver; 1: hard ones.
//
//   penumbra  its width at most, pixels
unsigned Lamps::points_of(const light::Source& source, const FrameScene& scene, std::size_t r,
                          double& penumbra) const {
  penumbra = 0;
  const std::optional<Emitter> emitter = emitter_of(source);
  if (!emitter || emitter->radius == 0) return 1;
  const Sphere sphere = sphere_of(scene, r);
  const double far = glm::length(sphere.centre - emitter->position) + sphere.radius;
  double near = far;
  for (std::size_t i = 0; i < scene.states.size(); ++i) {
    if (!scene.states[i].bounds) continue;
    const Sphere caster = sphere_of(scene.world[i], *scene.states[i].bounds);
    near = std::min(near, glm::length(caster.centre - emitter->position) - caster.radius);
  }
  near = std::max(near, emitter->radius);
  const double width = 2 * emitter->radius * std::max(far - near, 0.0) / near;
  const double focal = std::max(scene.camera.focal.x, scene.camera.focal.y);
  const double depth = scene.camera.projection == world::Projection::perspective
                           ? std::max(nearest_depth(scene, r), far * 0x1p-20)
                           : 1;
  const double pixels = width * focal / (depth * scene.pixel);
  penumbra = std::min(pixels, glm::length(Vec2(scene.camera.width, scene.camera.height)));
  if (softness_.points <= 1 || !(softness_.always || penumbra > kShownPenumbra)) return 1;
  unsigned points = std::min(softness_.points, kMostLampPoints);
  if (softness_.limited && scene.texels == 0)
    points = std::min(points, penumbra > kWidePenumbra ? kFewSunPoints : kFewSunPoints / 2);
  return std::max(std::min(points, scene.sun_points) / 4 * 4, 4u);
}

// Adds the maps of a receiver to wanted_, the brightest lamps first: of every lamp those of hard
// shadows, and of as many as there is room for all points.
void Lamps::find_maps(const FrameScene& scene, std::size_t r, SamplingReport& report) {
  Receiver& receiver = receivers_[r];
  receiver.first_map = static_cast<std::uint32_t>(wanted_.size());
  receiver.maps = 0;
  const std::uint32_t target = scene.visible.targets[r].target;
  const double sun = max_component(scene.world.sun().irradiance.value_or(Vec3(1)));
  double total = 0;
  std::vector<Lamp*> order;
  for (Lamp& lamp : receiver.lamps) {
    lamp.maps = 0;
    lamp.points = 1;
    total += lamp.irradiance;
    order.push_back(&lamp);
  }
  std::ranges::stable_sort(order, std::greater{}, &Lamp::irradiance);
  const std::size_t room = std::min<std::size_t>(kMostLampMaps, LampMaps::kMost - wanted_.size());
  unsigned without = 0;
  std::size_t used = 0;
  std::vector<Lamp*> shadowing;
  const Vec2 middle(0);
  for (Lamp* lamp : order) {
    if (lamp->irradiance < kShadowShare * total || lamp->irradiance < kShadowShareOfSun * sun) {
      ++without;
      continue;
    }
    if (is_at_camera(lamp->source, scene, r)) continue;
    const std::size_t maps = maps_of(lamp->source, {&middle, 1}, scene, r).size();
    if (used + maps > room) {
      ++without;
      continue;
    }
    used += maps;
    lamp->maps = static_cast<std::uint32_t>(maps);
    shadowing.push_back(lamp);
  }
  report.lamps_without_shadow = std::max(report.lamps_without_shadow, without);
  for (Lamp* lamp : shadowing) {
    double penumbra = 0;
    unsigned points = points_of(lamp->source, scene, r, penumbra);
    report.lamp_penumbra = std::max(report.lamp_penumbra, penumbra);
    const bool soft = points > 1;
    std::vector<LampMap> maps;
    for (;; points = points > 4 ? points / 8 * 4 : 1) {
      std::vector<Vec2> places(1, Vec2(0));
      if (points > 1) find_sun_points({.tangent = 1}, points, places);
      maps = maps_of(lamp->source, places, scene, r);
      if (points == 1 || used - lamp->maps + maps.size() <= room) break;
    }
    used += maps.size() - lamp->maps;
    lamp->points = points;
    lamp->maps = static_cast<std::uint32_t>(maps.size() / points);
    if (points > 1) report.lamps_soft = std::max(report.lamps_soft, points);
    if (soft && points == 1) ++report.lamps_hard;
    lamp->map = receiver.maps;
    for (LampMap& map : maps) {
      map.target = target;
      wanted_.push_back(std::move(map));
      ++receiver.maps;
    }
  }
}

// Sets the block of a receiver.
void Lamps::fill(const FrameScene& scene, std::size_t r, const Mat4& model_from_sample,
                 LampsBlock& block) const {
  const Receiver& receiver = receivers_[r];
  const world::Pose& pose = scene.world[scene.visible.targets[r].target].pose();
  const Vec3 origin = pose.rotation * Vec3(model_from_sample[3]);  // from the pose's translation
  block.count = static_cast<std::int32_t>(receiver.lamps.size());
  for (std::size_t k = 0; k < receiver.lamps.size(); ++k) {
    const Lamp& lamp = receiver.lamps[k];
    float* place = block.place + 4 * k;
    float* kind = block.kind + 4 * k;
    float* axis = block.axis + 4 * k;
    float* intensity = block.intensity + 4 * k;
    kind[1] = lamp.maps > 0 ? static_cast<float>(lamp.map) : -1.0f;
    kind[2] = static_cast<float>(lamp.points) * (lamp.maps > 1 ? -1.0f : 1.0f);
    axis[3] = -2;
    const std::optional<Emitter> emitter = emitter_of(lamp.source);
    if (!emitter) {
      const light::Incidence light = light::incidence(lamp.source, Vec3(0));
      copy_floats(light.to_light, place);
      place[3] = static_cast<float>(light.alpha2);
      copy_floats(light.irradiance, intensity);
      kind[0] = 2;
      kind[3] = static_cast<float>(light.limb);
      continue;
    }
    copy_floats((emitter->position - pose.translation) - origin, place);
    place[3] = static_cast<float>(emitter->radius * emitter->radius);
    copy_floats(emitter->axis, axis);
    if (emitter->half_angle < kPi) axis[3] = static_cast<float>(std::cos(emitter->half_angle));
    copy_floats(emitter->intensity, intensity);
    intensity[3] = static_cast<float>(emitter->exponent);
    kind[0] = emitter->disc ? 1 : 0;
  }
  if (receiver.maps == 0) return;
  block.half_map[0] = block.half_map[1] = static_cast<float>(maps_.side()) / 2;
  block.texel_size[0] = 1 / static_cast<float>(maps_.layers().width);
  block.texel_size[1] = 1 / static_cast<float>(maps_.layers().height);
  Mat4 world_from_sample(1);
  world_from_sample[3] = Vec4(origin + pose.translation, 1);
  for (std::size_t m = 0; m < receiver.maps; ++m) {
    const LampMap& map = wanted_[receiver.first_map + m];
    const Tile whole{0, 0, map.camera.width, map.camera.height};
    const Mat4 clip =
        clip_from_mesh(map.camera, whole, map.range, camera_from(map.camera, world_from_sample));
    copy_floats(clip, block.map_from_sample + 16 * m);
    const Mat4 planes = glm::transpose(glm::inverse(clip));
    double most = 1e-300;
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row) most = std::max(most, std::fabs(planes[column][row]));
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        block.map_plane_from_sample[12 * m + static_cast<std::size_t>(4 * row + column)] =
            static_cast<float>(planes[column][row] / most);
    const double span = map.range.far - map.range.near;
    const bool perspective = map.camera.projection == world::Projection::perspective;
    float* texel = block.texel_depth + 4 * m;
    texel[0] = static_cast<float>((perspective ? map.range.near * map.range.far / span : 1 / span) /
                                  map.camera.focal.x);
    texel[1] = static_cast<float>(map.layer);
    texel[2] = perspective ? static_cast<float>(map.range.near / map.range.far) : 1.0f;
    copy_floats((map.camera.position - pose.translation) - origin, block.eye + 4 * m);
  }
}

bool Lamps::update(Device::Impl& device, const FrameScene& scene, const std::vector<Mat4>& samples,
                   unsigned side, std::uint64_t bytes, SamplingReport& report, DiagnosticLog& log,
                   const Job& job) {
  if (!any_) return true;
  const GladGLContext& gl = device.context->gl();
  wanted_.clear();
  for (std::size_t r = 0; r < receivers_.size(); ++r) {
    report.lamps = std::max(report.lamps, static_cast<unsigned>(receivers_[r].lamps.size()));
    if (side > 0) find_maps(scene, r, report);
  }
  report.lamps_left_out = std::max(report.lamps_left_out, left_out_);
  if (report.lamps_hard > 0)
    log.report_file(
        Code("W5020"), {},
        fmt::format("shadows of {} are hard, though penumbrae are up to {:.3g} pixels wide: there "
                    "are maps for {} points of lamps on a target",
                    counted(report.lamps_hard, "lamp"), report.lamp_penumbra, kMostLampMaps));
  if (!maps_.update(device, scene, wanted_, side, bytes, log, job)) return false;
  blocks_.upload(gl, receivers_.size(),
                 [&](std::size_t r, LampsBlock& block) { fill(scene, r, samples[r], block); });
  return true;
}

void Lamps::bind(const GladGLContext& gl, std::size_t receiver) const {
  blocks_.bind(gl, kLampsBinding, receiver);
  if (receivers_[receiver].maps == 0) return;
  gl.BindTextureUnit(kShadowDepthsUnit, maps_.layers().depths.id());
  gl.BindTextureUnit(kShadowSlopesUnit, maps_.layers().slopes.id());
}

}  // namespace panwright::preview
