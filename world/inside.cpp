#include "world/inside.h"

namespace panwright::world {

namespace {

// Signed crossings of a closed mesh by the ray from a point along +x: 0 outside.
int crossings(const pan::MeshView& mesh, const Vec3& point) {
  int sum = 0;
  const auto corner = [&](std::size_t i) {
    const pan::layout::Float3& p = mesh.positions[mesh.indices[i]];
    return Vec3(p.x, p.y, p.z) - point;
  };
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Vec3 a = corner(i), b = corner(i + 1), c = corner(i + 2);
    // half-open: an edge counts for one of its two triangles, and so does a corner
    const bool above_a = a.z > 0, above_b = b.z > 0, above_c = c.z > 0;
    if (above_a == above_b && above_b == above_c) continue;
    // the edges that cross the plane z = 0, from below to above and back
    int turns = 0;
    const auto edge = [&](const Vec3& from, const Vec3& to, bool above_from, bool above_to) {
      if (above_from == above_to) return;
      // y of the crossing, from the lower end, so that both triangles of an edge agree
      const Vec3& low = above_to ? from : to;
      const Vec3& high = above_to ? to : from;
      const double y = low.y + (high.y - low.y) * (-low.z / (high.z - low.z));
      if (y > 0) turns += above_to ? 1 : -1;
    };
    edge(a, b, above_a, above_b);
    edge(b, c, above_b, above_c);
    edge(c, a, above_c, above_a);
    if (turns == 0) continue;
    // where the ray's line meets the triangle's plane
    const Vec3 normal = glm::cross(b - a, c - a);
    if (normal.x != 0 && glm::dot(normal, a) / normal.x > 0) sum += turns;
  }
  return sum;
}

}  // namespace

std::optional<Part> closed_part_around(const World& world, const Evaluation& evaluation,
                                       const Vec3& point) {
  for (std::size_t t = 0; t < world.size(); ++t) {
    const Instance& target = world[t];
    if (!target.visible()) continue;
    const pan::Model& model = *target.model();
    const Mat4 model_from_world = glm::inverse(target.pose().matrix());
    const Vec3 in_model(model_from_world * Vec4(point, 1));
    const EvaluatedInstance& nodes = evaluation[t];
    const auto inside = [](const Vec3& p, const Vec3& low, const Vec3& high) {
      for (int k = 0; k < 3; ++k)
        if (!(p[k] >= low[k] && p[k] <= high[k])) return false;
      return true;
    };
    if (!nodes.bounds || !inside(in_model, nodes.bounds->low, nodes.bounds->high)) continue;
    for (std::size_t i = 0; i < model.instances().size(); ++i) {
      const pan::layout::Instance& one = model.instances()[i];
      const pan::layout::Mesh& mesh = model.meshes()[one.mesh];
      if ((mesh.flags & pan::layout::kMeshClosed) == 0 || nodes.node_visible[one.node] == 0)
        continue;
      if (model.materials()[one.material].cutout_map >= 0) continue;
      const Vec3 origin(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
      const Vec3 in_mesh =
          Vec3(glm::inverse(nodes.model_from_nodes[one.node]) * Vec4(in_model, 1)) - origin;
      const Vec3 low(mesh.bounds_min[0], mesh.bounds_min[1], mesh.bounds_min[2]);
      const Vec3 high(mesh.bounds_max[0], mesh.bounds_max[1], mesh.bounds_max[2]);
      if (!inside(in_mesh, low, high)) continue;
      if (crossings(model.mesh(one.mesh), in_mesh) != 0) return Part{t, one.node};
    }
  }
  return std::nullopt;
}

}  // namespace panwright::world
