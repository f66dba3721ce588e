#include "preview/frame/shadow.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/axis_box.h"
#include "preview/frame/blocks.h"

namespace panwright::preview {
namespace {

void copy_half_map(const ShadowTiles& tiles, float half_map[2]) {
  half_map[0] = static_cast<float>(tiles.columns * tiles.side) / 2;
  half_map[1] = static_cast<float>(tiles.rows * tiles.side) / 2;
}

}  // namespace

double largest_shear(const LightSpace& frame, const SunDisc& disc) {
  return 2 * disc.tangent * frame.extent.z / std::min(frame.extent.x, frame.extent.y);
}

bool meets_column(const Mat4& sun_from_box, const Vec3& low, const Vec3& high, double shear) {
  AxisBox box;
  for (const Vec3& corner : corners(low, high)) box.add(Vec3(sun_from_box * Vec4(corner, 1)));
  const auto& [least, most] = box;
  const double edge =
      1 + 1e-6 + shear * std::max(std::fabs(least.z - 0.5), std::fabs(most.z - 0.5));
  return least.x <= edge && most.x >= -edge && least.y <= edge && most.y >= -edge && most.z > 0;
}

world::Pose relative_pose(const world::Pose& anchor, const world::Pose& model) {
  const Quat turn = glm::conjugate(anchor.rotation);
  return {turn * (model.translation - anchor.translation), turn * model.rotation};
}

void ShadowMaps::add_to(LightView& view, std::size_t receiver,
                        const Mat4& model_from_sample) const {
  const Place& place = places_[receiver];
  const Map& map = maps_[place.map];
  const ShadowTiles& tiles = map.layout.tiles;
  const bool tiled = !tiles.tiles.empty();
  const LightSpace frame = tiled ? light_space_in_map(tiles, 0) : map.layout.whole;
  const Mat4 anchor_from_sample = place.anchor_from_model * model_from_sample;
  Mat4 map_from_sample = frame.sun_from_model * anchor_from_sample;
  const Mat3 planes = frame.sun_normal_from_model * Mat3(anchor_from_sample);
  LightBlock& block = view.block;
  for (std::size_t t = 0; t < tiles.tiles.size(); ++t) {
    const Mat4 tile_from_sample = light_space_in_map(tiles, t).sun_from_model * anchor_from_sample;
    copy_floats(Vec3(tile_from_sample[3]), block.tile_place + 4 * t);
    block.tile_place[4 * t + 3] =
        static_cast<float>(tiles.tiles.front().texel / tiles.tiles[t].texel);
    const Vec4 inside = inside_of_tile(tiles, t);
    for (int k = 0; k < 4; ++k)
      block.tile_inside[4 * t + static_cast<std::size_t>(k)] = static_cast<float>(inside[k]);
  }
  if (tiled) map_from_sample[3] = Vec4(0, 0, 0, 1);
  copy_floats(map_from_sample, block.map_from_sample);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      block.map_plane_from_sample[4 * row + column] = static_cast<float>(planes[column][row]);
  copy_half_map(tiles, block.half_map);
  block.texel_size[0] = 1 / static_cast<float>(map.layers.width);
  block.texel_size[1] = 1 / static_cast<float>(map.layers.height);
  const Vec3& extent = map.layout.whole.extent;
  const double texel = std::max(extent.x, extent.y) / tiles.side;
  block.texel_depth = static_cast<float>(tiled ? 1 / tiles.depth : texel / extent.z);
  block.tiles = static_cast<std::int32_t>(tiles.tiles.size());
  block.points = static_cast<std::int32_t>(map.layout.points);
  const Vec3 size =
      tiled ? Vec3(tiles.columns, tiles.rows, 1) * Vec3(tiles.side, tiles.side, tiles.depth)
            : extent;
  for (std::size_t k = 0; k < map.points.size(); ++k) {
    const Vec2 shear = sun_shear(size, map.points[k]);
    for (int axis = 0; axis < 2; ++axis)
      block.disc[2 * k + static_cast<std::size_t>(axis)] = static_cast<float>(shear[axis]);
  }
  view.depths = map.layers.depths.id();
  view.slopes = map.layers.slopes.id();
}

bool ShadowMaps::make(const ContextLimits& limits, const GladGLContext& gl, Map& map,
                      DiagnosticLog& log) {
  const unsigned side = map.layout.tiles.side;
  const auto layers = static_cast<int>(map.layout.points);
  if (map.layers.make(gl, map.columns * side, map.rows * side, limits.framebuffer_side, layers))
    return true;
  log.report_file(
      Code("E5003"), {},
      fmt::format("the context has no memory for a shadow map of {} by {} texels{}",
                  map.columns * side, map.rows * side,
                  layers > 1 ? fmt::format(" for each of {} points of the Sun", layers) : ""));
  map.columns = 0;
  return false;
}

std::uint64_t ShadowMaps::texels_of(const Layout& layout) {
  const std::uint64_t side = layout.tiles.side;
  return std::uint64_t{layout.tiles.cells()} * side * side * layout.points;
}

std::uint64_t ShadowMaps::stored_texels() const {
  std::uint64_t texels = 0;
  for (const Map& map : maps_) texels += map.texels;
  return texels;
}

bool ShadowMaps::assign(const ContextLimits& limits, const GladGLContext& gl, std::uint64_t most,
                        DiagnosticLog& log) {
  const auto take = [&](Group& group, Map& map) {
    map.last_use = update_;
    group.map = static_cast<std::size_t>(&map - maps_.data());
  };
  const auto has_room = [](const Group& group, const Map& map) {
    return map.columns == group.layout.tiles.columns && map.rows == group.layout.tiles.rows &&
           map.layout.tiles.side == group.layout.tiles.side &&
           map.layout.points == group.layout.points;
  };
  for (Group& group : groups_)
    for (Map& map : maps_)
      if (map.last_use != update_ && map.drawn && map.to_sun == group.to_sun &&
          map.receivers == group.members && map.layout.tiles == group.layout.tiles &&
          map.layout.whole.extent == group.layout.whole.extent &&
          map.layout.points == group.layout.points) {
        take(group, map);
        map.layout = group.layout;
        break;
      }
  for (Group& group : groups_) {
    if (group.map != kNone) continue;
    // a map that is not asked for now is drawn anew before memory is taken for another one
    Map* chosen = nullptr;
    for (Map& map : maps_)
      if (map.last_use < image_ && has_room(group, map) &&
          (!chosen || map.last_use < chosen->last_use))
        chosen = &map;
    if (!chosen) {
      for (Map& map : maps_) {
        if (stored_texels() + texels_of(group.layout) <= most) break;
        if (map.last_use == update_) continue;
        map.columns = 0;
        map.texels = 0;
        map.drawn = false;
        map.layers = {};
      }
      for (Map& map : maps_)
        if (map.last_use != update_ && map.columns == 0) chosen = &map;
      if (!chosen) chosen = &maps_.emplace_back();
      chosen->columns = group.layout.tiles.columns;
      chosen->rows = group.layout.tiles.rows;
      chosen->texels = texels_of(group.layout);
      chosen->layout = group.layout;
      if (!make(limits, gl, *chosen, log)) return false;
    }
    chosen->drawn = false;
    chosen->to_sun = group.to_sun;
    chosen->receivers = group.members;
    chosen->layout = group.layout;
    take(group, *chosen);
  }
  return true;
}

// Adds to targets_ and casters_. Expects: frames_ are those of the map.
void ShadowMaps::add_casters(const FrameScene& scene, std::span<const Drawn> receivers, bool soft) {
  casters_.clear();
  const world::World& world = scene.world;
  const world::Pose& anchor = world[receivers.front().target].pose();
  for (std::uint32_t i = 0; i < world.size(); ++i) {
    const std::optional<AxisBox>& bounds = scene.states[i].bounds;
    if (!bounds) continue;
    if (std::any_of(receivers.begin(), receivers.end(),
                    [&](const Drawn& one) { return one.target == i; }))
      continue;
    const world::Pose pose = relative_pose(anchor, world[i].pose());
    const Mat4 anchor_from_model = pose.matrix();
    if (std::none_of(frames_.begin(), frames_.end(), [&](const LightSpace& frame) {
          return meets_column(frame.sun_from_model * anchor_from_model, bounds->low, bounds->high,
                              soft ? largest_shear(frame, disc_) : 0);
        }))
      continue;
    targets_.push_back(
        {i, false, true, {scene.states[i].shape_stamp, scene.states[i].level, pose}});
    casters_.push_back(targets_.back().member);
  }
}

bool ShadowMaps::refresh(Device::Impl& device, const FrameScene& scene, Group& group,
                         DiagnosticLog& log, const Job& job) {
  Map& map = maps_[group.map];
  frames_.clear();
  const ShadowTiles& tiles = map.layout.tiles;
  for (std::size_t t = 0; t < tiles.tiles.size(); ++t)
    frames_.push_back(light_space_of_tile(tiles, t));
  if (frames_.empty()) frames_.push_back(map.layout.whole);
  targets_.assign(group.targets.begin(), group.targets.end());
  add_casters(scene, group.targets, map.layout.points > 1);
  if (map.drawn && map.casters == casters_) return true;
  map.drawn = false;
  for (const Drawn& one : targets_)
    for (const DrawItem& item : scene.states[one.target].items())
      for (const bool instanced : {false, true})
        device.programs.shadow(item.variant.cutout, instanced);
  if (!device.programs_ready(log)) return false;
  if (!draw(device, map, scene.states, job)) {
    report_cancelled(log);
    return false;
  }
  map.casters = casters_;
  map.drawn = true;
  return true;
}

bool ShadowMaps::update(Device::Impl& device, const FrameScene& scene, const Limits& limits,
                        DiagnosticLog& log, const Job& job) {
  const GladGLContext& gl = device.context->gl();
  const ContextLimits& context = device.context->limits();
  const unsigned side = std::min(limits.side, context.framebuffer_side);
  const unsigned soft_side = std::min(limits.soft_side, side);
  const std::uint64_t cell = std::uint64_t{side} * side;
  const auto cells =
      static_cast<std::size_t>(std::max<std::uint64_t>(limits.bytes / (kTexelBytes * cell), 1));
  // points of the disc take up to four times the memory
  const std::uint64_t most =
      (limits.disc.points > 1 ? 4 : 1) * std::max(limits.bytes / kTexelBytes, cell);
  if (stored_texels() > most) maps_.clear();
  // of another disc every map is another one, in the same memory
  if (disc_ != limits.disc)
    for (Map& map : maps_) map.drawn = false;
  disc_ = limits.disc;
  ++update_;
  group(scene, cells);
  lay_out_all(scene, {side, cells, context.framebuffer_side / side, scene.pixel, 0}, soft_side,
              most, log);
  places_.assign(scene.visible.targets.size(), {});
  if (!assign(context, gl, most, log)) return false;
  for (Group& group : groups_) {
    if (!refresh(device, scene, group, log, job)) return false;
    for (std::size_t k = 0; k < group.receivers.size(); ++k)
      places_[group.receivers[k]] = {group.members[k].anchor_from_model.matrix(), group.map};
  }
  return true;
}

// What a point of the Sun sees of targets_ in one box.
void ShadowMaps::add_draws(const GladGLContext& gl, const LightSpace& frame, const Vec2& sun_point,
                           std::uint32_t tile, bool all_receivers, const TargetStates& states) {
  const Mat4 sun_from_model = sheared(sun_shear(frame.extent, sun_point)) * frame.sun_from_model;
  for (std::uint32_t t = 0; t < targets_.size(); ++t) {
    const Drawn& target = targets_[t];
    const std::span<const DrawItem> list = states[target.target].items();
    const Mat4 anchor_from_model = target.member.anchor_from_model.matrix();
    for (std::uint32_t i = 0; i < list.size(); ++i) {
      if (!list[i].visible) continue;
      const Mat4 anchor_from_mesh =
          target.anchor ? list[i].model_from_mesh : anchor_from_model * list[i].model_from_mesh;
      const Mat4 sun_from_mesh = sun_from_model * anchor_from_mesh;
      if ((target.caster || !all_receivers) &&
          !meets_column(sun_from_mesh, list[i].low, list[i].high, 0))
        continue;
      draws_.add(gl, target.target, i, tile, target.caster || !all_receivers, list[i],
                 sun_from_mesh);
    }
  }
}

// False: the job is cancelled.
bool ShadowMaps::draw(Device::Impl& device, Map& map, const TargetStates& states, const Job& job) {
  const GladGLContext& gl = device.context->gl();
  ++drawn_;
  find_sun_points(disc_, map.layout.points, map.points);
  const std::vector<ShadowTile>& tiles = map.layout.tiles.tiles;
  const auto show_tile = [&](std::uint32_t t) {
    const ShadowTile tile =
        tiles.empty() ? ShadowTile{Vec3(0), 0, 0, 0, map.layout.tiles.side} : tiles[t];
    gl.Viewport(static_cast<GLint>(tile.x), static_cast<GLint>(tile.y),
                static_cast<GLsizei>(tile.side), static_cast<GLsizei>(tile.side));
  };
  for (std::size_t layer = 0; layer < map.points.size(); ++layer) {
    draws_.clear();
    for (std::uint32_t tile = 0; tile < frames_.size(); ++tile)
      add_draws(gl, frames_[tile], map.points[layer], tile, tiles.empty(), states);
    map.layers.begin(gl, static_cast<int>(layer));
    if (!draws_.draw(device, states, std::cref(show_tile), false, job)) return false;
  }
  return true;
}

}  // namespace panwright::preview
