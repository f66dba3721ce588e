// Which receivers share a map, and how it is laid out.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/axis_box.h"
#include "preview/frame/shadow.h"

namespace panwright::preview {
namespace {

// where a target's origin of bounds lies in the world
Vec3 centre_of(const world::Instance& instance, const TargetState& state) {
  const Vec3 centre = state.bounds->low + 0.5 * (state.bounds->high - state.bounds->low);
  return instance.pose().translation + instance.pose().rotation * centre;
}

// What a pixel spans where targets are nearest, metres.
double nearest_pixel(const world::Camera& camera, const FrameScene& scene,
                     std::span<const std::uint32_t> receivers) {
  const double focal = std::max(camera.focal.x, camera.focal.y);
  if (camera.projection != world::Projection::perspective) return scene.pixel / focal;
  double near = INFINITY;
  double far = 0;
  for (const std::uint32_t receiver : receivers)
    for (const PlacedBox& box : scene.visible.targets[receiver].boxes)
      for (const Vec3& corner : corners(box.low, box.high)) {
        const double depth = Vec3(box.camera_from_mesh * Vec4(corner, 1)).z;
        near = std::min(near, depth);
        far = std::max(far, depth);
      }
  return std::max(near, far * 0x1p-20) / focal * scene.pixel;
}

// Maps of several points of the Sun cost more than all else of an image of limited time.
bool is_limited(const SunDisc& disc, const FrameScene& scene) {
  return disc.limited && scene.texels == 0;
}

// As many points of the Sun's disc as are asked for, half of them where pixels are too large to
// show the steps between them, few where time is limited. In an eclipse all of a target has the
// error of one place of a penumbra.
unsigned points_for(double penumbra, bool eclipse, const SunDisc& disc, const FrameScene& scene) {
  unsigned points = disc.points;
  if (eclipse)
    points = std::max(points, disc.most);
  else if (is_limited(disc, scene))
    points = std::min(points, penumbra > kWidePenumbra ? kFewSunPoints : kFewSunPoints / 2);
  else if (!disc.always && penumbra <= 2)
    points = std::max((points + 1) / 2, 2u);
  return std::min(points, scene.sun_points);
}

}  // namespace

std::vector<std::vector<std::uint32_t>> neighbour_groups(std::span<const Vec3> centres,
                                                         std::size_t most) {
  struct Group {
    std::vector<std::uint32_t> members;
    int axis = 0;
    double length = 0;
    double middle = 0;
  };
  const auto measured = [&](std::vector<std::uint32_t> members) {
    AxisBox box;
    for (const std::uint32_t i : members) box.add(centres[i]);
    const auto& [low, high] = box;
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

ShadowMaps::Group& ShadowMaps::add_group(std::size_t index) {
  Group& group = index < groups_.size() ? groups_[index] : groups_.emplace_back();
  group.receivers.clear();
  group.targets.clear();
  group.members.clear();
  group.map = kNone;
  return group;
}

void ShadowMaps::add_to(Group& group, const FrameScene& scene, std::uint32_t receiver) const {
  const world::World& world = scene.world;
  const std::uint32_t target = scene.visible.targets[receiver].target;
  const bool first = group.targets.empty();
  const std::uint32_t anchor_target = first ? target : group.targets.front().target;
  const world::Pose& anchor = world[anchor_target].pose();
  if (first)
    group.to_sun =
        glm::normalize(glm::conjugate(anchor.rotation) * glm::normalize(world.sun().direction));
  const world::Pose pose = first ? world::Pose{} : relative_pose(anchor, world[target].pose());
  group.targets.push_back(
      {target, first, false, {scene.states[target].shape_stamp, scene.states[target].level, pose}});
  group.members.push_back(group.targets.back().member);
  group.receivers.push_back(receiver);
}

void ShadowMaps::group(const FrameScene& scene, std::size_t most) {
  std::size_t count = 0;
  const std::vector<VisibleTarget>& receivers = scene.visible.targets;
  if (receivers.size() <= most) {
    for (std::uint32_t i = 0; i < receivers.size(); ++i) add_to(add_group(count++), scene, i);
  } else {
    std::vector<Vec3> centres;
    for (const VisibleTarget& one : receivers)
      centres.push_back(centre_of(scene.world[one.target], scene.states[one.target]));
    for (const std::vector<std::uint32_t>& neighbours : neighbour_groups(centres, most)) {
      Group& group = add_group(count++);
      for (const std::uint32_t i : neighbours) add_to(group, scene, i);
    }
  }
  groups_.resize(count);
}

// How far what may throw a shadow on the receivers of a group stands from them, along the Sun,
// metres.
double ShadowMaps::throw_in(const Group& group, const FrameScene& scene,
                            const LightSpace& whole) const {
  const world::World& world = scene.world;
  const world::Pose& anchor = world[group.targets.front().target].pose();
  const double shear = largest_shear(whole, disc_);
  double top = 1;
  for (std::uint32_t i = 0; i < world.size(); ++i) {
    const std::optional<AxisBox>& bounds = scene.states[i].bounds;
    if (!bounds || std::any_of(group.targets.begin(), group.targets.end(),
                               [&](const Drawn& one) { return one.target == i; }))
      continue;
    const Mat4 sun_from_model =
        whole.sun_from_model * relative_pose(anchor, world[i].pose()).matrix();
    if (!meets_column(sun_from_model, bounds->low, bounds->high, shear)) continue;
    for (const Vec3& corner : corners(bounds->low, bounds->high))
      top = std::max(top, Vec3(sun_from_model * Vec4(corner, 1)).z);
  }
  return top * whole.extent.z;
}

// Sets group.layout, as a map has it or anew, but for the points of the Sun's disc: 1 or more.
void ShadowMaps::lay_out(Group& group, const FrameScene& scene, const TileLimits& limits,
                         unsigned soft_side) {
  const Map* kept = nullptr;
  const world::Camera& camera = scene.camera;
  const ViewKey view{camera_from(camera, scene.world[group.targets.front().target].pose().matrix()),
                     camera.focal,
                     camera.principal,
                     Vec2(camera.width, camera.height),
                     camera.projection,
                     limits.cells,
                     limits.side,
                     soft_side,
                     scene.pixel};
  for (const Map& map : maps_)
    if (map.drawn && map.to_sun == group.to_sun && map.receivers == group.members &&
        map.layout.view.side == view.side && map.layout.view.soft_side == soft_side) {
      kept = &map;
      if (map.layout.view == view) break;
    }
  if (kept) {
    group.layout = kept->layout;
  } else {
    placed_.clear();
    for (const Drawn& one : group.targets) {
      const Mat4 anchor_from_model = one.member.anchor_from_model.matrix();
      for (const DrawItem& item : scene.states[one.target].items()) {
        placed_.push_back(item);
        if (!one.anchor) placed_.back().model_from_mesh = anchor_from_model * item.model_from_mesh;
      }
    }
    group.layout.bare = fitted_light_space(placed_, group.to_sun, soft_side);
  }
  Layout& layout = group.layout;
  const double pixel = nearest_pixel(camera, scene, group.receivers);
  layout.penumbra = 0;
  layout.eclipse = false;
  if (disc_.points > 1) {
    const double width = 2 * disc_.tangent * throw_in(group, scene, layout.bare);
    layout.eclipse = width > std::max(layout.bare.extent.x, layout.bare.extent.y);
    // no more of it shows than the image is wide
    layout.penumbra =
        std::min(width / pixel, glm::length(Vec2(camera.width, camera.height)) / scene.pixel);
  }
  const bool soft = disc_.points > 1 && (disc_.always || layout.penumbra > kShownPenumbra);
  const bool was_soft = kept && kept->layout.points > 1;
  // as much memory for many points as for few with finer texels, and for those of an eclipse
  const unsigned points = points_for(layout.penumbra, layout.eclipse, disc_, scene);
  const unsigned many_side = points > disc_.points ? std::max(soft_side / 2, 16u) : soft_side;
  const bool many = points > kFewSunPoints || is_limited(disc_, scene);
  const unsigned side = soft && many ? many_side : limits.side;
  if (kept && kept->layout.view == view && soft == was_soft && layout.tiles.side == side) return;
  layout.points = soft ? 2 : 1;
  layout.whole = soft ? widened(layout.bare, disc_.tangent) : layout.bare;
  shown_.clear();
  for (const std::uint32_t receiver : group.receivers) {
    const VisibleTarget& visible = scene.visible.targets[receiver];
    const TargetState& state = scene.states[visible.target];
    for (std::size_t k = 0; k < visible.items.size(); ++k)
      shown_.push_back({&visible.boxes[k], state.resources, state.model().model.get(),
                        state.items()[visible.items[k]].mesh});
  }
  layout.view = view;
  TileLimits own = limits;
  own.side = side;
  own.sun_tangent = soft ? disc_.tangent : 0;
  layout.tiles = finder_.find(camera, view.camera_from_model, layout.whole, shown_, own);
  shown_.clear();  // which hold models
  layout.texel = finder_.texel();
  layout.pixel = finder_.pixel();
  layout.finest = finder_.finest();
}

void ShadowMaps::lay_out_all(const FrameScene& scene, const TileLimits& limits, unsigned soft_side,
                             std::uint64_t most, DiagnosticLog& log) {
  std::size_t spare = limits.cells - std::min(limits.cells, groups_.size());
  std::size_t left = groups_.size();
  std::uint64_t hard_texels = 0;
  std::uint64_t soft_texels = 0;  // of one point
  for (Group& group : groups_) {
    // what one leaves goes to those behind it
    lay_out(group, scene, {limits.side, 1 + spare / left--, limits.cells_a_row, scene.pixel, 0},
            soft_side);
    spare -= group.layout.tiles.cells() - 1;
    const bool soft = group.layout.points > 1;
    group.layout.points = 1;
    (soft ? soft_texels : hard_texels) += texels_of(group.layout);
    if (soft) group.layout.points = 2;
  }
  edge_error_ = 0;
  penumbra_ = 0;
  disc_points_ = 1;
  struct {
    unsigned points = ~0u;
    unsigned asked = 0;
  } missed;
  const Group* worst = nullptr;
  double coarsest = kMostPixelsATexel;
  for (Group& group : groups_) {
    Layout& layout = group.layout;
    penumbra_ = std::max(penumbra_, layout.penumbra);
    if (layout.points > 1) {
      const auto room = static_cast<double>(most - std::min(most, hard_texels)) /
                        static_cast<double>(soft_texels);
      const unsigned asked = points_for(layout.penumbra, layout.eclipse, disc_, scene);
      layout.points = static_cast<unsigned>(std::clamp(std::floor(room), 2.0, 1.0 * asked));
      if (layout.points < missed.points) missed = {layout.points, asked};
      disc_points_ = disc_points_ > 1 ? std::min(disc_points_, layout.points) : layout.points;
    }
    const double coarse = layout.texel / layout.pixel;
    if (coarse > 0 && std::isfinite(coarse))
      edge_error_ = std::max(edge_error_, kEdgeOfTexel * coarse);
    if (!(coarse > coarsest)) continue;
    coarsest = coarse;
    worst = &group;
  }
  if (missed.points < missed.asked)
    log.report_file(
        Code("W5012"), {},
        fmt::format(
            "memory for shadows of {} points of the Sun's disc, expected {}: penumbrae have steps "
            "of {:.2g}, expected {:.2g} (RMS); a smaller --shadow-side allows more",
            missed.points, missed.asked, error_of_sun_points(missed.points),
            error_of_sun_points(missed.asked)));
  if (!worst) return;
  log.report_file(
      Code("W5012"), {},
      fmt::format("the shadow map of '{}' has texels of {:.3g} m at pixels of {:.3g} m: shadow "
                  "edges are off by up to {:.2g} pixels, expected {:.2g} ({})",
                  scene.world[worst->targets.front().target].name(), worst->layout.texel,
                  worst->layout.pixel, kEdgeOfTexel * coarsest, kEdgeOfTexel * kMostPixelsATexel,
                  worst->layout.finest > kMostPixelsATexel * worst->layout.pixel
                      ? "single precision allows no finer texels for such large triangles; use "
                        "smaller triangles"
                      : "a larger --shadow-side may give finer texels"));
}

}  // namespace panwright::preview
