#include "world/world.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/text.h"
#include "world/internal/missing_name.h"
#include "world/lamps.h"

namespace panwright::world {
namespace {

[[maybe_unused]] bool is_unit(const Quat& q) { return std::fabs(glm::dot(q, q) - 1) < 1e-6; }

[[maybe_unused]] bool is_sound(const Pose& pose) {
  return is_finite(pose.translation) && is_unit(pose.rotation);
}

[[maybe_unused]] bool is_sound(const NodeTransform& t) {
  return is_finite(t.translation) && is_unit(t.rotation) && is_finite(t.scale) && t.scale.x != 0 &&
         t.scale.y != 0 && t.scale.z != 0;
}

bool is_default(const NodeState& state) { return !state.transform && state.visible; }

bool before(const NodeState& state, std::uint32_t node) { return state.node < node; }

}  // namespace

const NodeState* Instance::node_state(std::uint32_t node) const {
  const auto at = std::lower_bound(node_states_.begin(), node_states_.end(), node, before);
  return at != node_states_.end() && at->node == node ? &*at : nullptr;
}

const JointState* Instance::joint_state(std::uint32_t joint) const {
  const auto at = std::ranges::lower_bound(joint_states_, joint, {}, &JointState::joint);
  return at != joint_states_.end() && at->joint == joint ? &*at : nullptr;
}

std::vector<geometry::JointValues> Instance::joint_values() const {
  std::vector<geometry::JointValues> values(model_->joints().size());
  for (std::size_t i = 0; i < values.size(); ++i)
    std::copy_n(model_->joints()[i].value, geometry::kMaxJointValues, values[i].begin());
  for (const JointState& state : joint_states_) values[state.joint] = state.values;
  if (!values.empty()) model_->joint_set().resolve(values);
  return values;
}

Result<std::size_t> World::add(std::string name, ModelPtr model, DiagnosticLog& log) {
  return add(std::move(name), std::move(model), Pose{}, log);
}

Result<std::size_t> World::add(std::string name, ModelPtr model, const Pose& pose,
                               DiagnosticLog& log) {
  assert(!name.empty() && model && model->checked() && is_sound(pose));
  if (find(name)) {
    log.report_file(Code("E5009"), {}, fmt::format("duplicate target name {}", in_quotes(name)),
                    "NAME=FILE gives a target another name");
    return failed;
  }
  if (size() == kMaxInstances) {
    log.report_file(Code("E5010"), {},
                    fmt::format("too many targets, expected at most {}", kMaxInstances));
    return failed;
  }
  Instance& instance = instances_.emplace_back();
  instance.name_ = std::move(name);
  instance.model_ = std::move(model);
  instance.pose_ = pose;
  instance.pose_stamp_ = next_stamp();
  instance.shape_stamp_ = next_stamp();
  for (Lamp& lamp : lamps_of(instance.name_, *instance.model_)) lamps_.push_back(std::move(lamp));
  stamp_ = next_stamp();
  return size() - 1;
}

void World::remove(std::size_t index) {
  assert(index < size());
  std::erase_if(lamps_, [&](const Lamp& lamp) {
    return lamp.carrier == Lamp::Carrier::node && lamp.target == instances_[index].name_;
  });
  instances_.erase(instances_.begin() + static_cast<std::ptrdiff_t>(index));
  stamp_ = next_stamp();
}

std::optional<std::size_t> World::find(std::string_view name) const {
  for (std::size_t i = 0; i < size(); ++i)
    if (instances_[i].name_ == name) return i;
  return std::nullopt;
}

Result<std::size_t> World::require(std::string_view name, DiagnosticLog& log) const {
  if (const auto index = find(name)) return *index;
  std::vector<std::string_view> names;
  for (const Instance& instance : instances_) names.push_back(instance.name_);
  report_missing(Code("E5011"), {}, "unknown target", name, names, log);
  return failed;
}

void World::set_pose(std::size_t index, const Pose& world_from_model) {
  assert(index < size() && is_sound(world_from_model));
  Instance& instance = instances_[index];
  if (instance.pose_ == world_from_model) return;
  instance.pose_ = world_from_model;
  instance.pose_stamp_ = next_stamp();
  stamp_ = next_stamp();
}

void World::set_visible(std::size_t index, bool visible) {
  assert(index < size());
  if (instances_[index].visible_ == visible) return;
  instances_[index].visible_ = visible;
  shape_changed(instances_[index]);
}

void World::shape_changed(Instance& instance) {
  instance.shape_stamp_ = next_stamp();
  stamp_ = next_stamp();
}

NodeState& World::state_of(Instance& instance, std::uint32_t node) {
  assert(node < instance.model_->nodes().size());
  auto& states = instance.node_states_;
  auto at = std::lower_bound(states.begin(), states.end(), node, before);
  if (at == states.end() || at->node != node) {
    NodeState state;
    state.node = node;
    at = states.insert(at, state);
  }
  return *at;
}

void World::set_node_transform(std::size_t index, std::uint32_t node,
                               const std::optional<NodeTransform>& parent_from_node) {
  assert(index < size() && (!parent_from_node || is_sound(*parent_from_node)));
  Instance& instance = instances_[index];
  const NodeState* old = instance.node_state(node);
  if ((old ? old->transform : std::nullopt) == parent_from_node) return;
  NodeState& state = state_of(instance, node);
  state.transform = parent_from_node;
  if (is_default(state))
    instance.node_states_.erase(instance.node_states_.begin() +
                                (&state - instance.node_states_.data()));
  shape_changed(instance);
}

void World::set_node_visible(std::size_t index, std::uint32_t node, bool visible) {
  assert(index < size());
  Instance& instance = instances_[index];
  const NodeState* old = instance.node_state(node);
  if ((old ? old->visible : true) == visible) return;
  NodeState& state = state_of(instance, node);
  state.visible = visible;
  if (is_default(state))
    instance.node_states_.erase(instance.node_states_.begin() +
                                (&state - instance.node_states_.data()));
  shape_changed(instance);
}

void World::set_joint(std::size_t index, std::uint32_t joint,
                      const std::optional<geometry::JointValues>& values, bool aimed) {
  assert(index < size());
  Instance& instance = instances_[index];
  assert(joint < instance.model_->joints().size());
  auto& states = instance.joint_states_;
  const auto at = std::ranges::lower_bound(states, joint, {}, &JointState::joint);
  const bool there = at != states.end() && at->joint == joint;
  if (there && values && at->values == *values) {
    at->aimed = aimed;
    return;
  }
  if (!values && !there) return;
  if (!values)
    states.erase(at);
  else if (there)
    *at = {joint, *values, aimed};
  else
    states.insert(at, {joint, *values, aimed});
  shape_changed(instance);
}

void World::set_sun(const Sun& sun) {
  if (sun_.set(sun)) stamp_ = next_stamp();
}

void World::set_lamps(std::vector<Lamp> lamps) {
  assert(std::ranges::count(lamps, true, &Lamp::on) <= static_cast<std::ptrdiff_t>(kMaxLamps) &&
         std::ranges::all_of(lamps, [](const Lamp& lamp) { return light::is_sound(lamp.source); }));
  if (lamps_ == lamps) return;
  lamps_ = std::move(lamps);
  stamp_ = next_stamp();
}

void World::set_lamp_on(std::size_t index, bool on) {
  if (lamps_[index].on == on) return;
  lamps_[index].on = on;
  stamp_ = next_stamp();
}

void World::set_white(const std::optional<Vec3>& white) {
  assert(!white || (is_finite(*white) && white->x >= 0 && white->y >= 0 && white->z >= 0));
  if (white_ == white) return;
  white_ = white;
  stamp_ = next_stamp();
}

void World::set_stars(const light::Stars& stars) {
  if (stars == stars_) return;
  stars_ = stars;
  stamp_ = next_stamp();
}

void World::set_sky(std::vector<light::Body> bodies, bool sun_visible) {
  assert(
      std::ranges::all_of(bodies, [](const light::Body& body) { return light::is_sound(body); }));
  if (bodies_ == bodies && sun_visible_ == sun_visible) return;
  bodies_ = std::move(bodies);
  sun_visible_ = sun_visible;
  stamp_ = sky_stamp_ = next_stamp();
}

Vec3 World::white() const {
  return white_.value_or(sun().irradiance ? light::kSolarIrradiance : Vec3(1));
}

}  // namespace panwright::world
