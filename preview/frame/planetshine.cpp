#include "preview/frame/planetshine.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "preview/frame/blocks.h"
#include "sky/sky.h"

namespace panwright::preview {
namespace {

static_assert(sky::ShineTable::kSide == kPlanetTableSide);

// Number of shadow maps. docs/sky.md has their errors.
std::size_t planet_groups_for(const RenderOptions& options) {
  constexpr double kExact = 0.01;
  return options.samples == 0 && options.pixel_error <= kExact ? kMostPlanetParts : 4;
}

// Metres about a point within which the light of all bodies stays as it is to 3e-4.
double reach_of_light(const world::World& world, const Vec3& point) {
  constexpr double kShare = 3e-4;
  double nearest = INFINITY;
  for (const light::Body& body : world.bodies()) {
    const double largest = std::max({body.radii.x, body.radii.y, body.radii.z});
    nearest = std::min(nearest, glm::length(body.centre - point) - largest);
  }
  return std::max(kShare * nearest, 0.0);
}

// Direction and angular radius.
void copy_disc(const materials::Incidence& light, float* to) {
  constexpr double kLeastRadius = 1e-4;
  copy_floats(light.to_light, to);
  to[3] = static_cast<float>(std::max(std::sqrt(8 * light.alpha2), kLeastRadius));
}

// The view of a target from a group.
LampMap map_of(const FrameScene& scene, std::size_t r, const Vec3& to_light) {
  const AxisBox& box = *scene.state(r).bounds;
  const std::uint32_t target = scene.visible.targets[r].target;
  const world::Pose& pose = scene.world[target].pose();
  const double radius = 0.5 * glm::length(box.high - box.low);
  const Vec3 centre = pose.translation + pose.rotation * (0.5 * (box.low + box.high));
  return parallel_map(centre, radius, to_light, target);
}

}  // namespace

void Planetshine::begin_image(const world::World& world, const RenderOptions& options) {
  const std::size_t groups = planet_groups_for(options);
  ground_ = options.ground_shine;
  if (groups == groups_ && sky_stamp_ == world.sky_stamp() && sun_stamp_ == world.sun_stamp())
    return;
  groups_ = groups;
  sky_stamp_ = world.sky_stamp();
  sun_stamp_ = world.sun_stamp();
  for (Light& light : lights_)
    if (light.texture) spare_.push_back(std::move(light.texture));
  lights_.clear();
}

// Light of bodies and terrain in parts and groups.
Planetshine::Light Planetshine::found(const sky::Sky& sky, const Vec3& point,
                                      const light::GroundShine* ground, std::size_t groups) {
  Light light;
  light.point = point;
  light.groups = sky::planet_lights(sky, point, groups, ground);
  if (light.groups.empty()) return light;
  const auto nearest = [&](const Vec3& direction) {
    return static_cast<std::size_t>(
        std::ranges::max_element(light.groups, {},
                                 [&](const materials::Incidence& group) {
                                   return glm::dot(group.to_light, direction);
                                 }) -
        light.groups.begin());
  };
  const std::size_t most = ground != nullptr ? kMostGroundParts : kMostPlanetParts;
  const auto parts = sky::planet_lights(sky, point, most, ground);
  // each part to the group nearest to it
  std::vector<std::size_t> of_parts, of_shadows;
  for (const materials::Incidence& part : parts) of_parts.push_back(nearest(part.to_light));
  const std::vector<light::ShineShadow> none;
  const std::vector<light::ShineShadow>& shadows = ground != nullptr ? ground->shadows : none;
  assert(shadows.size() <= kMostGroundParts);
  for (const light::ShineShadow& shadow : shadows)
    of_shadows.push_back(nearest(shadow.place - point));
  for (std::size_t g = 0; g < light.groups.size(); ++g) {
    for (std::size_t k = 0; k < parts.size(); ++k)
      if (of_parts[k] == g) light.parts.push_back(parts[k]);
    light.ends.push_back(light.parts.size());
    for (std::size_t k = 0; k < shadows.size(); ++k)
      if (of_shadows[k] == g) light.shadows.push_back(shadows[k]);
    light.shadow_ends.push_back(light.shadows.size());
  }
  light.table = sky::shine_table(sky, point, ground);
  return light;
}

// The index of the light that serves a point.
std::size_t Planetshine::light_at(const world::World& world, const Vec3& point,
                                  const light::GroundShine* ground) {
  const Stamp stamp = ground != nullptr ? ground->stamp : 0;
  for (std::size_t i = 0; i < lights_.size(); ++i)
    if (lights_[i].ground == stamp && glm::length(point - lights_[i].point) <= lights_[i].reach)
      return i;
  Light light = found(sky::Sky(world), point, ground, groups_);
  light.ground = stamp;
  light.reach = ground != nullptr ? 0 : reach_of_light(world, point);
  lights_.push_back(std::move(light));
  return lights_.size() - 1;
}

void Planetshine::begin_scene(const FrameScene& scene) {
  constexpr std::size_t kMostKept = 64;
  any_ = false;
  receivers_.clear();
  if (scene.world.bodies().empty() && ground_ == nullptr) return;
  if (lights_.size() > kMostKept) {
    for (Light& light : lights_)
      if (light.texture) spare_.push_back(std::move(light.texture));
    lights_.clear();
  }
  for (const VisibleTarget& visible : scene.visible.targets) {
    Receiver receiver;
    const light::GroundShine* ground = nullptr;
    if (ground_ != nullptr && visible.target < ground_->size()) {
      const light::GroundShine& shine = (*ground_)[visible.target];
      if (shine.stamp != 0) ground = &shine;
    }
    receiver.light = light_at(
        scene.world,
        ground != nullptr ? ground->middle : scene.world[visible.target].pose().translation,
        ground);
    any_ = any_ || !lights_[receiver.light].groups.empty();
    receivers_.push_back(receiver);
  }
}

void Planetshine::upload(const GladGLContext& gl, Light& light) {
  constexpr auto kRow = static_cast<GLsizei>(sky::ShineTable::kRow);
  constexpr auto kLayers = static_cast<GLsizei>(sky::ShineTable::kLayers);
  if (spare_.empty()) {
    light.texture = make_texture_array(gl, GL_RGBA32F, kRow, kRow, kLayers);
    const GLuint id = light.texture.id();
    gl.TextureParameteri(id, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TextureParameteri(id, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TextureParameteri(id, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TextureParameteri(id, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  } else {
    light.texture = std::move(spare_.back());
    spare_.pop_back();
  }
  gl.TextureSubImage3D(light.texture.id(), 0, 0, 0, 0, kRow, kRow, kLayers, GL_RGBA, GL_FLOAT,
                       light.table.rgba.data());
}

void Planetshine::fill(const FrameScene& scene, std::size_t r, const Mat4& model_from_sample,
                       PlanetsBlock& block) const {
  const Receiver& receiver = receivers_[r];
  const Light& light = lights_[receiver.light];
  const world::Pose& pose = scene.world[scene.visible.targets[r].target].pose();
  for (std::size_t k = 0; k < light.parts.size(); ++k) {
    copy_disc(light.parts[k], block.part + 4 * k);
    copy_floats(light.parts[k].irradiance, block.irradiance + 4 * k);
  }
  block.groups = static_cast<std::int32_t>(light.groups.size());
  for (std::size_t g = 0; g < light.groups.size(); ++g) {
    const Vec3& irradiance = light.groups[g].irradiance;
    copy_disc(light.groups[g], block.group + 4 * g);
    block.members[4 * g] = static_cast<float>(irradiance.x + irradiance.y + irradiance.z);
    block.members[4 * g + 1] = static_cast<float>(light.ends[g]);
    block.members[4 * g + 2] = receiver.maps == 0 ? 0 : static_cast<float>(light.shadow_ends[g]);
    block.map[4 * g] = -1;
  }
  if (receiver.maps == 0) return;
  const double half = maps_.side() / 2.0;
  block.half_map = static_cast<float>(half);
  block.texel_size[0] = 1 / static_cast<float>(maps_.layers().width);
  block.texel_size[1] = 1 / static_cast<float>(maps_.layers().height);
  Mat4 world_from_sample(1);
  world_from_sample[3] = Vec4(pose.rotation * Vec3(model_from_sample[3]) + pose.translation, 1);
  for (std::size_t k = 0; k < light.shadows.size(); ++k) {
    const light::ShineShadow& shadow = light.shadows[k];
    copy_floats(shadow.place - Vec3(world_from_sample[3]), block.shadow_place + 4 * k);
    block.shadow_place[4 * k + 3] = static_cast<float>(shadow.area / kPi);
    copy_floats(shadow.normal, block.shadow_normal + 4 * k);
    copy_floats(shadow.light, block.shadow_light + 4 * k);
  }
  for (std::size_t k = 0; k < receiver.maps; ++k) {
    const LampMap& map = wanted_[receiver.first_map + k];
    const Tile whole{0, 0, map.camera.width, map.camera.height};
    const Mat4 clip =
        clip_from_mesh(map.camera, whole, map.range, camera_from(map.camera, world_from_sample));
    double size[3];
    for (int row = 0; row < 3; ++row) {
      size[row] = glm::length(Vec3(clip[0][row], clip[1][row], clip[2][row]));
      for (int column = 0; column < 4; ++column)
        block.map_from_sample[12 * k + static_cast<std::size_t>(4 * row + column)] =
            static_cast<float>(clip[column][row]);
    }
    const double depth = size[2] / std::max(size[0], 1e-300);  // of a width
    block.map[4 * k] = static_cast<float>(map.layer);
    block.map[4 * k + 1] = static_cast<float>(depth / half);
    block.map[4 * k + 2] = static_cast<float>(depth * depth);
  }
}

bool Planetshine::update(Device::Impl& device, const FrameScene& scene,
                         const std::vector<Mat4>& samples, unsigned side, std::uint64_t bytes,
                         DiagnosticLog& log, const Job& job) {
  if (!any_) return true;
  const GladGLContext& gl = device.context->gl();
  wanted_.clear();
  for (std::size_t r = 0; r < receivers_.size(); ++r) {
    Receiver& receiver = receivers_[r];
    Light& light = lights_[receiver.light];
    if (!light.groups.empty() && !light.texture) upload(gl, light);
    receiver.first_map = wanted_.size();
    receiver.maps = 0;
    if (side == 0 || wanted_.size() + light.groups.size() > LampMaps::kMost) continue;
    for (const materials::Incidence& group : light.groups)
      wanted_.push_back(map_of(scene, r, group.to_light));
    receiver.maps = light.groups.size();
  }
  if (!maps_.update(device, scene, wanted_, side, bytes, log, job)) return false;
  blocks_.upload(gl, receivers_.size(),
                 [&](std::size_t r, PlanetsBlock& block) { fill(scene, r, samples[r], block); });
  return true;
}

void Planetshine::bind(const GladGLContext& gl, std::size_t receiver) const {
  const Light& light = lights_[receivers_[receiver].light];
  blocks_.bind(gl, kPlanetsBinding, receiver);
  if (light.texture) gl.BindTextureUnit(kPlanetLightUnit, light.texture.id());
  if (receivers_[receiver].maps > 0)
    gl.BindTextureUnit(kPlanetDepthsUnit, maps_.layers().depths.id());
}

}  // namespace panwright::preview
