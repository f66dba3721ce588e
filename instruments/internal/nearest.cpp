#include "instruments/internal/nearest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/parallel.h"
#include "geometry/mesh/closest.h"

namespace panwright::instruments {

namespace {

// of lengths: what corners, maps and boxes round by, and much more
constexpr double kSlack = 1e-9;

std::array<Vec3, 3> corners_of(const pan::MeshView& mesh, std::uint32_t triangle) {
  std::array<Vec3, 3> out;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& p = mesh.positions[mesh.indices[std::size_t{3} * triangle + k]];
    out[k] = Vec3(p.x, p.y, p.z);
  }
  return out;
}

std::unique_ptr<geometry::BoxTree> tree_of(const pan::MeshView& mesh) {
  std::vector<AxisBox> boxes(mesh.indices.size() / 3);
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    for (const Vec3& corner : corners_of(mesh, i)) boxes[i].add(corner);
  auto tree = std::make_unique<geometry::BoxTree>();
  tree->build(std::move(boxes));
  return tree;
}

}  // namespace

std::shared_ptr<const NearestSearch::MeshTrees> NearestSearch::meshes_of(
    const std::shared_ptr<const trace::Model>& model, const Job& job) {
  auto& known = meshes_[model.get()];
  if (known != nullptr) return known;
  auto made = std::make_shared<MeshTrees>();
  made->model = model;
  made->trees.resize(model->model()->meshes().size());
  std::vector<const trace::Model::Part*> placed(made->trees.size());
  for (const trace::Model::Part& part : model->parts()) placed[part.mesh_index] = &part;
  parallel_for(
      placed.size(),
      [&](std::size_t i) {
        if (placed[i] != nullptr) made->trees[i] = tree_of(placed[i]->mesh);
      },
      job);
  known = made;
  return known;
}

void NearestSearch::update(const trace::Scene& scene, const Job& job) {
  scene_ = &scene;
  std::unordered_map<const trace::Target*, std::shared_ptr<const Parts>> states;
  targets_.assign(scene.targets().size(), nullptr);
  for (const std::uint32_t i : scene.visible()) {
    const std::shared_ptr<const trace::Target>& target = scene.targets()[i].target;
    std::shared_ptr<const Parts>& state = states[target.get()];
    if (const auto same = states_.find(target.get()); same != states_.end()) state = same->second;
    if (state == nullptr) {
      auto made = std::make_shared<Parts>();
      made->target = target;
      made->meshes = meshes_of(target->shared_model(), job);
      std::vector<AxisBox> boxes;
      for (std::size_t k = 0; k < target->parts().size(); ++k) {
        const trace::Model::Part& part = target->model().parts()[target->parts()[k]];
        const trace::Affine& place = target->placements()[k].model_from_mesh;
        AxisBox& box = boxes.emplace_back();
        for (const double x : {part.low.x, part.high.x})
          for (const double y : {part.low.y, part.high.y})
            for (const double z : {part.low.z, part.high.z}) box.add(place(Vec3(x, y, z)));
        box.widen(kSlack * box.longest());
        const double smallest = stretch_of(Mat4(place.linear)).smallest;
        const Mat3 inverse = glm::inverse(place.linear);
        const bool flat = !(smallest > 0) || !is_finite(inverse[0]) || !is_finite(inverse[1]) ||
                          !is_finite(inverse[2]);
        made->parts.push_back({flat ? Mat3(1) : inverse, flat ? 0 : smallest});
      }
      made->tree.build(std::move(boxes));
      state = made;
    }
    targets_[i] = state;
  }
  states_ = std::move(states);
  std::erase_if(meshes_, [](const auto& entry) { return entry.second.use_count() == 1; });
}

// Improves the best by the parts of a target; limit: m², of the best.
void NearestSearch::improve(const Parts& parts, std::uint32_t target, const Vec3& point,
                            std::optional<NearestPoint>& best, double& limit) const {
  const trace::Target& traced = *parts.target;
  parts.tree.near(point, limit, [&](std::uint32_t number) {
    const std::uint32_t index = traced.parts()[number];
    const trace::Model::Part& part = traced.model().parts()[index];
    const trace::Affine& place = traced.placements()[number].model_from_mesh;
    const auto take = [&](std::uint32_t triangle) {
      std::array<Vec3, 3> corners = corners_of(part.mesh, triangle);
      for (Vec3& corner : corners) corner = place(corner);
      const Vec3 nearest = geometry::closest_point(corners, point);
      const Vec3 offset = nearest - point;
      const double squared = glm::dot(offset, offset);
      if (!(squared <= limit)) return;
      if (best && squared == best->squared &&
          std::tie(target, index, triangle) >= std::tie(best->target, best->part, best->triangle))
        return;
      best = {squared, nearest, target, index, triangle, {}};
      limit = squared;
    };
    const Parts::Part& placed = parts.parts[number];
    if (!(placed.smallest > 0)) {
      for (std::uint32_t i = 0; i < part.mesh.indices.size() / 3; ++i) take(i);
      return;
    }
    // a distance in the mesh's frame is at most that in the model's over the smallest stretch
    const double slack = (1 + kSlack) / placed.smallest;
    double squared = limit * slack * slack;
    parts.meshes->trees[part.mesh_index]->near(placed.mesh_from * (point - place.offset), squared,
                                               [&](std::uint32_t triangle) {
                                                 take(triangle);
                                                 squared = limit * slack * slack;
                                               });
  });
  if (traced.ground() == nullptr) return;
  const auto ground = traced.ground()->closest(point, std::sqrt(limit));
  if (!ground) return;
  limit = ground->distance * ground->distance;
  best = {limit,        ground->point.position, target, trace::Hit::kGround, ground->point.triangle,
          ground->point};
}

std::optional<NearestPoint> NearestSearch::nearest(const Vec3& world_point) const {
  std::optional<NearestPoint> best;
  double limit = std::numeric_limits<double>::infinity();
  for (const std::uint32_t i : scene_->visible()) {
    const trace::RigidFrame& frame = scene_->targets()[i].frame;
    // a row times a matrix: the inverse of a rotation is its transpose
    improve(*targets_[i], i, (world_point - frame.position) * frame.world_from, best, limit);
  }
  return best;
}

}  // namespace panwright::instruments
