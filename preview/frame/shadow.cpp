#include "preview/frame/shadow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "preview/frame/blocks.h"

namespace panwright::preview {
namespace {

// Uniform block of the shadow shaders, in std140.
struct alignas(16) ShadowBlock {
  float texel_depth;  // what one texel measures, as a share of the map's depth
  float half_side;    // texels
  float padding[2];
};

// Whether a box may throw a shadow into the box of a map: it meets its column, and is not behind
// all of it.
bool meets_column(const Mat4& sun_from_box, const Vec3& low, const Vec3& high) {
  constexpr double kEdge = 1 + 1e-6;
  Vec3 least(INFINITY);
  Vec3 most(-INFINITY);
  for (const Vec3& corner : corners(low, high)) {
    const Vec3 at(sun_from_box * Vec4(corner, 1));
    least = glm::min(least, at);
    most = glm::max(most, at);
  }
  return least.x <= kEdge && most.x >= -kEdge && least.y <= kEdge && most.y >= -kEdge && most.z > 0;
}

// where a target's origin of bounds lies in the world
Vec3 centre_of(const world::Instance& instance, const TargetState& state) {
  const Vec3 centre = state.bounds->min + 0.5 * (state.bounds->max - state.bounds->min);
  return instance.pose().translation + instance.pose().rotation * centre;
}

}  // namespace

world::Pose relative_pose(const world::Pose& anchor, const world::Pose& model) {
  const Quat turn = glm::conjugate(anchor.rotation);
  return {turn * (model.translation - anchor.translation), turn * model.rotation};
}

void light_space_sample(const SunPlace& place, const pan::layout::Mesh& mesh, const DrawItem& item,
                        bool flat, DrawBlock& block) {
  const LightSpace& frame = place.frame;
  const Mat4 sun_from_mesh =
      frame.sun_from_model *
      (place.anchor ? item.model_from_mesh : place.anchor_from_model * item.model_from_mesh);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      block.sun_from_mesh[4 * row + column] = static_cast<float>(sun_from_mesh[column][row]);
  copy_floats(frame.sun_normal_from_model * (place.anchor
                                                 ? item.model_normal_from_mesh
                                                 : place.anchor_turn * item.model_normal_from_mesh),
              block.sun_normal_from_mesh);
  // a chord is as deep below the smooth surface as others stand out of it
  block.normal_offset[0] = flat ? 0.0f : static_cast<float>(2 * mesh.error);
}

std::vector<std::vector<std::uint32_t>> neighbour_groups(std::span<const Vec3> centres,
                                                         std::size_t most) {
  struct Group {
    std::vector<std::uint32_t> members;
    int axis = 0;
    double length = 0;
    double middle = 0;
  };
  const auto measured = [&](std::vector<std::uint32_t> members) {
    Vec3 low(INFINITY);
    Vec3 high(-INFINITY);
    for (const std::uint32_t i : members) {
      low = glm::min(low, centres[i]);
      high = glm::max(high, centres[i]);
    }
    Group group{std::move(members), 0, 0, 0};
    for (int axis = 0; axis < 3; ++axis)
      if (high[axis] - low[axis] > group.length) {
        group.axis = axis;
        group.length = high[axis] - low[axis];
        group.middle = low[axis] + 0.5 * group.length;
      }
    return group;
  };
  std::vector<Group> groups;
  if (centres.size() <= most) {
    for (std::uint32_t i = 0; i < centres.size(); ++i) groups.push_back({{i}, 0, 0, 0});
  } else {
    std::vector<std::uint32_t> all(centres.size());
    std::iota(all.begin(), all.end(), 0u);
    groups.push_back(measured(std::move(all)));
    while (groups.size() < most) {
      const auto widest =
          std::max_element(groups.begin(), groups.end(),
                           [](const Group& a, const Group& b) { return a.length < b.length; });
      if (!(widest->length > 0)) break;
      std::vector<std::uint32_t> near;
      std::vector<std::uint32_t> far;
      for (const std::uint32_t i : widest->members)
        (centres[i][widest->axis] <= widest->middle ? near : far).push_back(i);
      if (far.empty() || near.empty()) break;  // as near as double tells
      *widest = measured(std::move(near));
      groups.push_back(measured(std::move(far)));
    }
  }
  std::vector<std::vector<std::uint32_t>> result;
  for (Group& group : groups) result.push_back(std::move(group.members));
  std::sort(result.begin(), result.end());
  return result;
}

bool ShadowMaps::make(const GladGLContext& gl, Map& map, DiagnosticLog& log) const {
  const auto size = static_cast<GLsizei>(side_);
  map.depths = make_texture_2d(gl, 1, GL_DEPTH_COMPONENT32F, size, size);
  map.slopes = make_texture_2d(gl, 1, GL_RG16F, size, size);
  map.limits = make_stream_buffer(gl);
  gl.NamedBufferStorage(map.limits.id(), sizeof(ShadowBlock), nullptr, GL_DYNAMIC_STORAGE_BIT);
  for (const GlTexture* texture : {&map.depths, &map.slopes}) {
    gl.TextureParameteri(texture->id(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TextureParameteri(texture->id(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  }
  GLuint id = 0;
  gl.CreateFramebuffers(1, &id);
  map.framebuffer = GlFramebuffer(gl, id);
  gl.NamedFramebufferTexture(id, GL_DEPTH_ATTACHMENT, map.depths.id(), 0);
  gl.NamedFramebufferTexture(id, GL_COLOR_ATTACHMENT0, map.slopes.id(), 0);
  if (gl.CheckNamedFramebufferStatus(id, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE &&
      gl.GetError() == GL_NO_ERROR)
    return true;
  log.report_file(
      Code::E5003, {},
      fmt::format("the context has no memory for a shadow map of {} by {} texels", side_, side_));
  return false;
}

bool ShadowMaps::assign(const GladGLContext& gl, DiagnosticLog& log) {
  for (Group& group : groups_)
    for (Map& map : maps_)
      if (map.last_use != update_ && map.to_sun == group.to_sun && map.receivers == group.members) {
        map.last_use = update_;
        group.map = static_cast<std::size_t>(&map - maps_.data());
        break;
      }
  for (Group& group : groups_) {
    if (group.map != kNone) continue;
    auto oldest = maps_.begin();
    for (auto map = maps_.begin(); map != maps_.end(); ++map)
      if (map->last_use < oldest->last_use) oldest = map;
    // a map that nobody asks for now is drawn anew before memory is taken for another one
    if (oldest == maps_.end() || oldest->last_use == update_) {
      Map map;
      if (!make(gl, map, log)) return false;
      maps_.push_back(std::move(map));
      oldest = maps_.end() - 1;
    }
    oldest->to_sun = Vec3(0);
    oldest->receivers = group.members;
    oldest->last_use = update_;
    group.map = static_cast<std::size_t>(oldest - maps_.begin());
  }
  return true;
}

// Adds to targets_ and casters_.
void ShadowMaps::add_casters(const Map& map, const world::World& world, const TargetStates& states,
                             std::span<const Drawn> receivers) {
  casters_.clear();
  const world::Pose& anchor = world[receivers.front().target].pose();
  for (std::uint32_t i = 0; i < world.size(); ++i) {
    if (!states[i].bounds) continue;
    if (std::any_of(receivers.begin(), receivers.end(),
                    [&](const Drawn& one) { return one.target == i; }))
      continue;
    const world::Pose pose = relative_pose(anchor, world[i].pose());
    if (!meets_column(map.frame.sun_from_model * pose.matrix(), states[i].bounds->min,
                      states[i].bounds->max))
      continue;
    targets_.push_back({i, false, true, {states[i].shape_stamp, pose}});
    casters_.push_back(targets_.back().member);
  }
}

ShadowMaps::Group& ShadowMaps::add_group(std::size_t index) {
  Group& group = index < groups_.size() ? groups_[index] : groups_.emplace_back();
  group.receivers.clear();
  group.targets.clear();
  group.members.clear();
  group.map = kNone;
  return group;
}

void ShadowMaps::add_to(Group& group, const world::World& world, const TargetStates& states,
                        std::span<const std::uint32_t> receivers, std::uint32_t receiver) const {
  const std::uint32_t target = receivers[receiver];
  const bool first = group.targets.empty();
  const std::uint32_t anchor_target = first ? target : group.targets.front().target;
  const world::Pose& anchor = world[anchor_target].pose();
  if (first)
    group.to_sun =
        glm::normalize(glm::conjugate(anchor.rotation) * glm::normalize(world.sun().direction));
  const world::Pose pose = first ? world::Pose{} : relative_pose(anchor, world[target].pose());
  group.targets.push_back({target, first, false, {states[target].shape_stamp, pose}});
  group.members.push_back(group.targets.back().member);
  group.receivers.push_back(receiver);
}

void ShadowMaps::group(const world::World& world, const TargetStates& states,
                       std::span<const std::uint32_t> receivers, std::size_t most) {
  std::size_t count = 0;
  if (receivers.size() <= most) {
    for (std::uint32_t i = 0; i < receivers.size(); ++i)
      add_to(add_group(count++), world, states, receivers, i);
  } else {
    std::vector<Vec3> centres;
    for (const std::uint32_t target : receivers)
      centres.push_back(centre_of(world[target], states[target]));
    for (const std::vector<std::uint32_t>& neighbours : neighbour_groups(centres, most)) {
      Group& group = add_group(count++);
      for (const std::uint32_t i : neighbours) add_to(group, world, states, receivers, i);
    }
  }
  groups_.resize(count);
}

bool ShadowMaps::refresh(Device::Impl& device, const world::World& world,
                         const TargetStates& states, Group& group, DiagnosticLog& log,
                         const Job& job) {
  Map& map = maps_[group.map];
  const bool refit = map.to_sun != group.to_sun;
  if (refit) {
    placed_.clear();
    for (const Drawn& one : group.targets) {
      const Mat4 anchor_from_model = one.member.anchor_from_model.matrix();
      for (const DrawItem& item : states[one.target].items()) {
        placed_.push_back(item);
        if (!one.anchor) placed_.back().model_from_mesh = anchor_from_model * item.model_from_mesh;
      }
    }
    map.frame = fitted_light_space(placed_, group.to_sun, side_);
  }
  targets_.assign(group.targets.begin(), group.targets.end());
  add_casters(map, world, states, group.targets);
  if (!refit && map.casters == casters_) return true;
  map.to_sun = Vec3(0);
  for (const Drawn& one : targets_)
    for (const DrawItem& item : states[one.target].items()) {
      std::string problem;
      if (device.programs.shadow(item.variant.cutout, false, &problem) &&
          device.programs.shadow(item.variant.cutout, true, &problem))
        continue;
      log.report_file(Code::E5001, {},
                      fmt::format("{} refuses a shader: {}", device.context->renderer(), problem));
      return false;
    }
  if (!draw(device, map, states, job)) {
    report_cancelled(log);
    return false;
  }
  map.casters = casters_;
  map.to_sun = group.to_sun;
  return true;
}

bool ShadowMaps::update(Device::Impl& device, const world::World& world, const TargetStates& states,
                        std::span<const std::uint32_t> receivers, unsigned side,
                        std::uint64_t max_bytes, DiagnosticLog& log, const Job& job) {
  const GladGLContext& gl = device.context->gl();
  side = std::min(side, device.context->limits().framebuffer_side);
  const auto most =
      static_cast<std::size_t>(std::max<std::uint64_t>(max_bytes / (kTexelBytes * side * side), 1));
  if (side != side_ || maps_.size() > most) maps_.clear();
  side_ = side;
  ++update_;
  if (!stream_) {
    stride_ = block_stride(gl, sizeof(DrawBlock));
    stream_.emplace(gl);
  }
  group(world, states, receivers, most);
  places_.assign(receivers.size(), {});
  if (!assign(gl, log)) return false;
  for (Group& group : groups_) {
    if (!refresh(device, world, states, group, log, job)) return false;
    for (std::size_t k = 0; k < group.receivers.size(); ++k) {
      const world::Pose& pose = group.members[k].anchor_from_model;
      places_[group.receivers[k]] = {
          {maps_[group.map].frame, k == 0, pose.matrix(), glm::mat3_cast(pose.rotation)},
          group.map};
    }
  }
  return true;
}

// What is drawn of targets_, and its blocks.
void ShadowMaps::upload(const Map& map, const TargetStates& states) {
  draws_.clear();
  blocks_.clear();
  for (std::uint32_t t = 0; t < targets_.size(); ++t) {
    const Drawn& target = targets_[t];
    const std::span<const DrawItem> list = states[target.target].items();
    const Mat4 anchor_from_model = target.member.anchor_from_model.matrix();
    for (std::uint32_t i = 0; i < list.size(); ++i) {
      if (!list[i].visible) continue;
      const Mat4 anchor_from_mesh =
          target.anchor ? list[i].model_from_mesh : anchor_from_model * list[i].model_from_mesh;
      const Mat4 sun_from_mesh = map.frame.sun_from_model * anchor_from_mesh;
      if (target.caster && !meets_column(sun_from_mesh, list[i].low, list[i].high)) continue;
      DrawBlock block{};
      copy_floats(sun_from_mesh, block.clip_from_mesh);
      block.id[0] = i + 1;
      copy_repeat(list[i], block);
      draws_.push_back({t, i});
      blocks_.resize(blocks_.size() + stride_);
      std::memcpy(blocks_.data() + blocks_.size() - stride_, &block, sizeof block);
    }
  }
  // what is bound of the last blocks reaches beyond them
  first_block_ = stream_->upload(blocks_, kInstancesAtOnce * stride_);
}

// False: the job is cancelled.
bool ShadowMaps::draw(Device::Impl& device, const Map& map, const TargetStates& states,
                      const Job& job) {
  const GladGLContext& gl = device.context->gl();
  ++drawn_;
  upload(map, states);
  const double texel = std::max(map.frame.extent.x, map.frame.extent.y) / side_;
  const ShadowBlock limits{
      static_cast<float>(texel / map.frame.extent.z), static_cast<float>(side_) / 2, {}};
  gl.NamedBufferSubData(map.limits.id(), 0, sizeof limits, &limits);

  gl.BindFramebuffer(GL_FRAMEBUFFER, map.framebuffer.id());
  gl.Viewport(0, 0, static_cast<GLsizei>(side_), static_cast<GLsizei>(side_));
  gl.Enable(GL_DEPTH_TEST);
  const float nothing = 0;
  gl.ClearBufferfv(GL_DEPTH, 0, &nothing);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, kShadowBinding, map.limits.id());
  const DrawItem* last = nullptr;
  std::uint32_t last_target = ~0u;
  const auto item_at = [&](std::size_t k) -> const DrawItem& {
    return states[targets_[draws_[k].target].target].items()[draws_[k].item];
  };
  bool were_instanced = false;
  std::size_t at_once = 1;
  for (std::size_t k = 0; k < draws_.size(); k += at_once) {
    std::size_t end = k;  // of its target's
    while (end < draws_.size() && end - k < kInstancesAtOnce &&
           draws_[end].target == draws_[k].target)
      ++end;
    at_once = drawn_at_once(k, end, item_at);
    const bool instanced = at_once > 1;
    const Drawn& target = targets_[draws_[k].target];
    const TargetState& state = states[target.target];
    const GpuModel& gpu = state.model().gpu;
    const DrawItem& item = state.items()[draws_[k].item];
    const pan::layout::Mesh& mesh = state.model().model->meshes()[item.mesh];
    if (draws_[k].target != last_target) {
      last = nullptr;
      last_target = draws_[k].target;
      if (target.caster) gl.Enable(GL_DEPTH_CLAMP);
    }
    if (!last || item.variant.cutout != last->variant.cutout || instanced != were_instanced)
      gl.UseProgram(device.programs.shadow(item.variant.cutout, instanced, nullptr));
    if (!last || item.closed != last->closed)
      item.closed ? gl.Enable(GL_CULL_FACE) : gl.Disable(GL_CULL_FACE);
    if (!last || item.mirrored != last->mirrored) gl.FrontFace(item.mirrored ? GL_CW : GL_CCW);
    if (item.variant.cutout) gpu.bind_maps(draws_[k].item);
    if (!last || item.mesh != last->mesh) gpu.bind_vertices(mesh, item.mesh);
    gl.BindBufferRange(
        GL_UNIFORM_BUFFER, kDrawBinding, stream_->id(),
        static_cast<GLintptr>(first_block_ + k * stride_),
        static_cast<GLsizeiptr>((instanced ? kInstancesAtOnce : 1) * sizeof(DrawBlock)));
    if (!gpu.draw(mesh, item.mesh, at_once, job)) return false;
    were_instanced = instanced;
    last = &item;
  }
  gl.Disable(GL_DEPTH_CLAMP);
  return true;
}

void ShadowMaps::bind(const GladGLContext& gl, std::size_t receiver) const {
  const Map& map = maps_[places_[receiver].map];
  gl.BindTextureUnit(kShadowDepthsUnit, map.depths.id());
  gl.BindTextureUnit(kShadowSlopesUnit, map.slopes.id());
  gl.BindBufferBase(GL_UNIFORM_BUFFER, kShadowBinding, map.limits.id());
}

}  // namespace panwright::preview
