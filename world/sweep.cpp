#include "world/sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <set>

#include "base/axis_box.h"
#include "geometry/ray/box_tree.h"

namespace panwright::world {
namespace {

// The box around a box that is moved.
AxisBox moved(const AxisBox& box, const Mat4& m) {
  const Vec3 half = 0.5 * box.extent();
  const Vec3 at(m * Vec4(box.centre(), 1));
  Vec3 reach(0);
  for (int k = 0; k < 3; ++k) reach += glm::abs(Vec3(m[k])) * half[k];
  return {at - reach, at + reach};
}

// The triangles of a mesh with a tree of their boxes.
class MeshTree {
 public:
  MeshTree(const pan::Model& model, std::size_t mesh) {
    const double* o = model.meshes()[mesh].origin;
    const pan::MeshView view = model.mesh(mesh);
    std::vector<AxisBox> boxes;
    for (std::size_t i = 0; i < view.indices.size(); i += 3) {
      std::array<Vec3, 3>& triangle = triangles_.emplace_back();
      AxisBox& box = boxes.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const pan::layout::Float3& p = view.positions[view.indices[i + k]];
        triangle[k] = Vec3(o[0] + double{p.x}, o[1] + double{p.y}, o[2] + double{p.z});
        box.add(triangle[k]);
      }
    }
    tree_.build(std::move(boxes));
  }

  const AxisBox& box() const { return tree_.box(); }

  // Whether some triangle of this mesh cuts one of another, which `own_from_other` places.
  bool cuts(const MeshTree& other, const Mat4& own_from_other, double slack) const {
    return tree_.meet(
        other.tree_, [&](const AxisBox& box) { return moved(box, own_from_other); },
        [&](std::uint32_t i, std::uint32_t j) {
          const auto &t = triangles_[i], &u = other.triangles_[j];
          const Vec3 a[3] = {t[0], t[1], t[2]};
          Vec3 b[3];
          for (std::size_t k = 0; k < 3; ++k) b[k] = Vec3(own_from_other * Vec4(u[k], 1));
          return triangles_cut(a, b, slack);
        });
  }

 private:
  std::vector<std::array<Vec3, 3>> triangles_;
  geometry::BoxTree tree_;
};

// Where a triangle crosses the line in which two planes meet: an interval along it. `d`: signed
// distances of its corners from the other plane, on both sides of it.
void interval(const Vec3 (&t)[3], const double (&d)[3], const Vec3& line, double (&out)[2]) {
  int n = 0;
  double at[4] = {};
  for (int i = 0; i < 3 && n < 4; ++i) {
    const int j = (i + 1) % 3;
    if (d[i] == 0) at[n++] = glm::dot(line, t[i]);
    if ((d[i] < 0 && d[j] > 0) || (d[i] > 0 && d[j] < 0))
      at[n++] = glm::dot(line, t[i] + (d[i] / (d[i] - d[j])) * (t[j] - t[i]));
  }
  out[0] = *std::min_element(at, at + n);
  out[1] = *std::max_element(at, at + n);
}

// Distances of the corners from a plane, those within the slack 0. False: all on one side.
bool crosses(const Vec3 (&t)[3], const Vec3& normal, const Vec3& point, double slack,
             double (&d)[3]) {
  bool above = false, below = false;
  for (int i = 0; i < 3; ++i) {
    d[i] = glm::dot(normal, t[i] - point);
    if (std::fabs(d[i]) <= slack) d[i] = 0;
    above = above || d[i] > 0;
    below = below || d[i] < 0;
  }
  return above && below;
}

}  // namespace

// Möller, "A Fast Triangle-Triangle Intersection Test", 1997; triangles in one plane do not cut.
bool triangles_cut(const Vec3 (&a)[3], const Vec3 (&b)[3], double slack) {
  const auto normal = [](const Vec3(&t)[3]) { return glm::cross(t[1] - t[0], t[2] - t[0]); };
  Vec3 na = normal(a), nb = normal(b);
  const double la = glm::length(na), lb = glm::length(nb);
  if (!(la > 0) || !(lb > 0)) return false;
  na /= la;
  nb /= lb;
  double da[3], db[3];
  if (!crosses(a, nb, b[0], slack, da) || !crosses(b, na, a[0], slack, db)) return false;
  const Vec3 line = glm::cross(na, nb);
  const double length = glm::length(line);
  if (!(length > 0)) return false;
  double ia[2], ib[2];
  interval(a, da, line / length, ia);
  interval(b, db, line / length, ib);
  return std::min(ia[1], ib[1]) - std::max(ia[0], ib[0]) > slack;
}

namespace {

class Sweeper {
 public:
  Sweeper(const World& world, std::size_t target, const Job& job)
      : world_(world), target_(target), model_(*world[target].model()), job_(job) {
    trees_.resize(model_.meshes().size());
    const auto size = exact_bounds(world[target]);
    slack_ = size ? 1e-9 * size->diagonal() : 0;
  }

  SweptJoint sweep(std::uint32_t joint, std::uint32_t steps) {
    SweptJoint out;
    out.joint = joint;
    out.positions = steps;
    const pan::layout::Joint& record = model_.joints()[joint];
    const bool limited = (record.flags & pan::layout::kJointLimited) != 0;
    out.from = limited ? record.lower[0] : -kPi;
    out.to = limited ? record.upper[0] : kPi;
    const EvaluatedInstance now = evaluated(world_[target_]);
    const std::vector<char> moving = moved_by(joint);
    std::vector<std::uint32_t> movers, others;
    for (std::uint32_t i = 0; i < model_.instances().size(); ++i) {
      const std::uint32_t node = model_.instances()[i].node;
      if (now.node_visible[node]) (moving[node] ? movers : others).push_back(i);
    }
    AxisBox swept;
    World world = world_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, Collision> met;
    std::map<std::pair<std::uint32_t, std::uint32_t>, bool> met_now;
    for (std::uint32_t k = 0; k < steps; ++k) {
      job_.poll();
      const double share = static_cast<double>(k) / (steps - 1);
      const double value = k + 1 == steps ? out.to : out.from + share * (out.to - out.from);
      geometry::JointValues values{};
      values[0] = value;
      world.set_joint(target_, joint, values);
      const EvaluatedInstance at = evaluated(world[target_]);
      std::vector<AxisBox> boxes(model_.instances().size());
      for (const std::uint32_t i : movers) boxes[i] = box_of(i, at);
      for (const std::uint32_t i : others) boxes[i] = box_of(i, at);
      for (const std::uint32_t i : movers) {
        swept.add(boxes[i]);
        for (const std::uint32_t j : others) {
          if (!boxes[i].meets(boxes[j]) || !meet(i, j, at)) continue;
          const std::pair nodes(model_.instances()[i].node, model_.instances()[j].node);
          const auto [known, first] = met_now.try_emplace({i, j}, false);
          if (first) known->second = box_of(i, now).meets(box_of(j, now)) && meet(i, j, now);
          if (known->second) continue;
          const auto [collision, added] = met.try_emplace(nodes);
          Collision& c = collision->second;
          if (added) {
            c.node_a = nodes.first;
            c.node_b = nodes.second;
            c.first = value;
          }
          if (added || c.last != value) ++c.positions;
          c.last = value;
        }
      }
    }
    if (movers.empty()) swept.add(Vec3(0));
    out.bounds = swept;
    for (const auto& [nodes, collision] : met) out.collisions.push_back(collision);
    return out;
  }

 private:
  // Nodes at and below that of a joint, and of those that follow it.
  std::vector<char> moved_by(std::uint32_t joint) const {
    std::vector<char> moves(model_.joints().size(), 0);
    moves[joint] = 1;
    for (bool more = true; more;) {
      more = false;
      for (std::size_t j = 0; j < moves.size(); ++j) {
        const std::int32_t leader = model_.joints()[j].mimic;
        if (moves[j] || leader < 0 || !moves[static_cast<std::size_t>(leader)]) continue;
        moves[j] = more = true;
      }
    }
    std::vector<char> nodes(model_.nodes().size(), 0);
    for (std::size_t j = 0; j < moves.size(); ++j)
      if (moves[j]) nodes[model_.joints()[j].node] = 1;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const std::int32_t parent = model_.nodes()[n].parent;
      if (parent >= 0 && nodes[static_cast<std::size_t>(parent)]) nodes[n] = 1;
    }
    return nodes;
  }

  const MeshTree& tree(std::uint32_t mesh) {
    if (!trees_[mesh]) trees_[mesh] = std::make_unique<MeshTree>(model_, mesh);
    return *trees_[mesh];
  }

  AxisBox box_of(std::uint32_t i, const EvaluatedInstance& at) {
    const pan::layout::Instance& placed = model_.instances()[i];
    return moved(tree(placed.mesh).box(), at.model_from_nodes[placed.node]);
  }

  bool meet(std::uint32_t i, std::uint32_t j, const EvaluatedInstance& at) {
    const pan::layout::Instance &a = model_.instances()[i], &b = model_.instances()[j];
    const Mat4 a_from_b = glm::inverse(at.model_from_nodes[a.node]) * at.model_from_nodes[b.node];
    return tree(a.mesh).cuts(tree(b.mesh), a_from_b, slack_);
  }

  const World& world_;
  std::size_t target_;
  const pan::Model& model_;
  const Job& job_;
  std::vector<std::unique_ptr<MeshTree>> trees_;
  double slack_ = 0;
};

}  // namespace

Result<std::vector<SweptJoint>> swept(const World& world, std::size_t target,
                                      std::span<const std::uint32_t> joints, std::uint32_t steps,
                                      DiagnosticLog& log, const Job& job) {
  return run_job(job, log, [&]() -> Result<std::vector<SweptJoint>> {
    const pan::Model& model = *world[target].model();
    std::vector<std::uint32_t> chosen(joints.begin(), joints.end());
    if (chosen.empty()) {
      chosen.resize(model.joints().size());
      std::iota(chosen.begin(), chosen.end(), 0u);
    }
    std::erase_if(chosen, [&](std::uint32_t j) {
      const pan::layout::Joint& joint = model.joints()[j];
      const auto kind = static_cast<geometry::JointKind>(joint.kind);
      const bool limited = (joint.flags & pan::layout::kJointLimited) != 0;
      return joint.mimic >= 0 || geometry::value_count(kind) != 1 ||
             (!limited && kind != geometry::JointKind::continuous &&
              kind != geometry::JointKind::revolute);
    });
    Sweeper sweeper(world, target, job);
    std::vector<SweptJoint> out;
    for (const std::uint32_t joint : chosen) out.push_back(sweeper.sweep(joint, steps));
    return out;
  });
}

}  // namespace panwright::world
