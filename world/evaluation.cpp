#include "world/evaluation.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "world/internal/missing_name.h"

namespace panwright::world {
namespace {

std::optional<AxisBox> unless_empty(const AxisBox& box) {
  return box.empty() ? std::nullopt : std::optional(box);
}

Vec3 vec3(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

void InstanceEvaluation::begin(const Instance& instance) {
  model_ = instance.model();
  const std::size_t count = model_->nodes().size();
  joints_ = model_->joint_set();
  initial_.resize(joints_.size());
  for (std::size_t i = 0; i < initial_.size(); ++i)
    std::copy_n(model_->joints()[i].value, geometry::kMaxJointValues, initial_[i].begin());
  values_.clear();
  states_.clear();
  at_rest_.resize(count);
  for (std::size_t i = 0; i < count; ++i) at_rest_[i] = pan::parent_from_node(model_->nodes()[i]);
  local_.resize(count);
  boxes_.resize(model_->instances().size());
  result_.model_from_nodes.resize(count);
  result_.node_visible.assign(count, 0);
}

// Node matrices and visibility; moved_ are those whose matrix is new. As
// pan::Model::world_from_nodes, the same bits where no state differs. Returns whether any is, or
// visibility has changed.
bool InstanceEvaluation::place(const Instance& instance) {
  const bool first = values_.size() != joints_.size() || moved_.size() != local_.size();
  next_ = initial_;
  for (const JointState& state : instance.joint_states()) next_[state.joint] = state.values;
  joints_.resolve(next_);
  moved_.assign(local_.size(), first);
  for (std::size_t j = 0; j < next_.size(); ++j)
    if (!first && next_[j] != values_[j]) moved_[model_->joints()[j].node] = 1;
  const auto transforms = [](std::span<const NodeState> states, std::vector<char>& moved,
                             std::span<const NodeState> others) {
    auto other = others.begin();
    for (const NodeState& state : states) {
      while (other != others.end() && other->node < state.node) ++other;
      const bool same =
          other != others.end() && other->node == state.node && other->transform == state.transform;
      if (!same) moved[state.node] = 1;
    }
  };
  transforms(instance.node_states(), moved_, states_);
  transforms(states_, moved_, instance.node_states());
  bool changed = false;
  auto state = instance.node_states().begin();
  const auto end = instance.node_states().end();
  std::size_t joint = 0;
  for (std::size_t i = 0; i < local_.size(); ++i) {
    const pan::layout::Node& node = model_->nodes()[i];
    assert(node.parent < static_cast<std::int64_t>(i));
    const auto parent = static_cast<std::size_t>(node.parent);
    const NodeState* own = state != end && state->node == i ? &*state++ : nullptr;
    const std::size_t first_joint = joint;
    while (joint < joints_.size() && model_->joints()[joint].node == i) ++joint;
    if (moved_[i]) {
      Mat4 matrix = own && own->transform ? own->transform->matrix() : at_rest_[i];
      for (std::size_t j = first_joint; j < joint; ++j)
        matrix = geometry::affine_product(matrix, geometry::motion(joints_[j], next_[j]));
      local_[i] = matrix;
    } else if (node.parent >= 0) {
      moved_[i] = moved_[parent];
    }
    if (moved_[i])
      result_.model_from_nodes[i] =
          node.parent >= 0 ? geometry::affine_product(result_.model_from_nodes[parent], local_[i])
                           : local_[i];
    const bool visible = instance.visible() && (!own || own->visible) &&
                         (node.parent < 0 || result_.node_visible[parent] != 0);
    changed = changed || moved_[i] || visible != (result_.node_visible[i] != 0);
    result_.node_visible[i] = visible;
  }
  values_.swap(next_);
  states_.assign(instance.node_states().begin(), instance.node_states().end());
  return changed || first;
}

void InstanceEvaluation::bound() {
  AxisBox all;
  const auto placed = model_->instances();
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const std::uint32_t node = placed[i].node;
    if (moved_[node]) {
      const pan::layout::Mesh& mesh = model_->meshes()[placed[i].mesh];
      const Mat4& matrix = result_.model_from_nodes[node];
      AxisBox box;
      for (int corner = 0; corner < 8; ++corner) {
        Vec3 point = vec3(mesh.origin);
        for (int axis = 0; axis < 3; ++axis)
          point[axis] += double{(corner >> axis & 1 ? mesh.bounds_max : mesh.bounds_min)[axis]};
        box.add(Vec3(matrix * Vec4(point, 1)));
      }
      boxes_[i] = box;
    }
    if (!result_.node_visible[node]) continue;
    all.add(boxes_[i]);
  }
  result_.bounds = unless_empty(all);
}

void InstanceEvaluation::update(const Instance& instance) {
  if (model_ != instance.model()) {
    begin(instance);
    moved_.clear();
  }
  if (place(instance)) bound();
  result_.shape_stamp = instance.shape_stamp();
}

EvaluatedInstance evaluated(const Instance& instance) {
  InstanceEvaluation evaluation;
  evaluation.update(instance);
  return evaluation.result();
}

void Evaluation::update(const World& world) {
  if (stamp_ == world.stamp() && instances_.size() == world.size()) return;
  instances_.resize(world.size());
  for (std::size_t i = 0; i < world.size(); ++i)
    if (instances_[i].result().shape_stamp != world[i].shape_stamp())
      instances_[i].update(world[i]);
  stamp_ = world.stamp();
}

std::optional<AxisBox> exact_bounds(const Instance& instance) {
  const EvaluatedInstance nodes = evaluated(instance);
  const pan::Model& model = *instance.model();
  AxisBox box;
  for (const pan::layout::Instance& placed : model.instances()) {
    if (!nodes.node_visible[placed.node]) continue;
    const Vec3 origin = vec3(model.meshes()[placed.mesh].origin);
    const Mat4& matrix = nodes.model_from_nodes[placed.node];
    for (const pan::layout::Float3& p : model.mesh(placed.mesh).positions)
      box.add(Vec3(matrix * Vec4(origin + Vec3(p.x, p.y, p.z), 1.0)));
  }
  return unless_empty(box);
}

bool place_in_frame(Camera& camera, const World& world, std::size_t index, std::string_view name,
                    DiagnosticLog& log) {
  const Instance& instance = world[index];
  const pan::Model& model = *instance.model();
  if (const auto found = model.find_frame(name)) {
    const pan::layout::Frame& frame = model.frames()[*found];
    const EvaluatedInstance nodes = evaluated(instance);
    place_in_frame(
        camera, instance.pose().matrix() * nodes.model_from_nodes[frame.node], vec3(frame.origin),
        Quat(frame.rotation[0], frame.rotation[1], frame.rotation[2], frame.rotation[3]));
    return true;
  }
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < model.frames().size(); ++i) names.push_back(model.frame_name(i));
  report_missing(Code("E5005"), model.name(), "unknown frame", name, names, log);
  return false;
}

}  // namespace panwright::world
