#include "world/evaluation.h"

#include <cassert>
#include <cmath>

#include "world/internal/missing_name.h"

namespace panwright::world {
namespace {

struct Box {
  Vec3 low{HUGE_VAL};
  Vec3 high{-HUGE_VAL};
  void add(const Vec3& point) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
  std::optional<Bounds> bounds() const {
    if (!(low.x <= high.x)) return std::nullopt;
    return Bounds{low, high};
  }
};

Vec3 vec3(const double* v) { return {v[0], v[1], v[2]}; }

// Node matrices from the model with the states that differ from it. As
// pan::Model::world_from_nodes, the same bits where none does.
void place_nodes(const Instance& instance, EvaluatedInstance& result) {
  const pan::Model& model = *instance.model();
  const std::size_t count = model.nodes().size();
  result.model_from_nodes.resize(count);
  result.node_visible.resize(count);
  auto state = instance.node_states().begin();
  const auto end = instance.node_states().end();
  for (std::size_t i = 0; i < count; ++i) {
    const pan::layout::Node& node = model.nodes()[i];
    assert(node.parent < static_cast<std::int64_t>(i));
    const NodeState* own = state != end && state->node == i ? &*state++ : nullptr;
    Mat4 matrix = own && own->transform ? own->transform->matrix() : pan::parent_from_node(node);
    bool visible = instance.visible() && (!own || own->visible);
    if (node.parent >= 0) {
      matrix = result.model_from_nodes[static_cast<std::size_t>(node.parent)] * matrix;
      visible = visible && result.node_visible[static_cast<std::size_t>(node.parent)] != 0;
    }
    result.model_from_nodes[i] = matrix;
    result.node_visible[i] = visible;
  }
}

}  // namespace

EvaluatedInstance evaluated(const Instance& instance) {
  EvaluatedInstance result;
  result.shape_stamp = instance.shape_stamp();
  place_nodes(instance, result);
  const pan::Model& model = *instance.model();
  Box box;
  for (const pan::layout::Instance& placed : model.instances()) {
    if (!result.node_visible[placed.node]) continue;
    const pan::layout::Mesh& mesh = model.meshes()[placed.mesh];
    const Mat4& matrix = result.model_from_nodes[placed.node];
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 point = vec3(mesh.origin);
      for (int axis = 0; axis < 3; ++axis)
        point[axis] += double{(corner >> axis & 1 ? mesh.bounds_max : mesh.bounds_min)[axis]};
      box.add(Vec3(matrix * Vec4(point, 1)));
    }
  }
  result.bounds = box.bounds();
  return result;
}

void Evaluation::update(const World& world) {
  if (stamp_ == world.stamp() && instances_.size() == world.size()) return;
  instances_.resize(world.size());
  for (std::size_t i = 0; i < world.size(); ++i)
    if (instances_[i].shape_stamp != world[i].shape_stamp()) instances_[i] = evaluated(world[i]);
  stamp_ = world.stamp();
}

std::optional<Bounds> exact_bounds(const Instance& instance) {
  EvaluatedInstance nodes;
  place_nodes(instance, nodes);
  const pan::Model& model = *instance.model();
  Box box;
  for (const pan::layout::Instance& placed : model.instances()) {
    if (!nodes.node_visible[placed.node]) continue;
    const Vec3 origin = vec3(model.meshes()[placed.mesh].origin);
    const Mat4& matrix = nodes.model_from_nodes[placed.node];
    for (const pan::layout::Float3& p : model.mesh(placed.mesh).positions)
      box.add(Vec3(matrix * Vec4(origin + Vec3(p.x, p.y, p.z), 1.0)));
  }
  return box.bounds();
}

bool place_in_frame(Camera& camera, const World& world, std::size_t index, std::string_view name,
                    DiagnosticLog& log) {
  const Instance& instance = world[index];
  const pan::Model& model = *instance.model();
  if (const auto found = model.find_frame(name)) {
    const pan::layout::Frame& frame = model.frames()[*found];
    EvaluatedInstance nodes;
    place_nodes(instance, nodes);
    place_in_frame(
        camera, instance.pose().matrix() * nodes.model_from_nodes[frame.node], vec3(frame.origin),
        Quat(frame.rotation[0], frame.rotation[1], frame.rotation[2], frame.rotation[3]));
    return true;
  }
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < model.frames().size(); ++i) names.push_back(model.frame_name(i));
  report_missing(Code::E5005, model.name(), "unknown frame", name, names, log);
  return false;
}

}  // namespace panwright::world
