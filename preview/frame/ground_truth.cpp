#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "preview/frame/ground_truth.h"

namespace panwright::preview {
namespace {

// A ray of the camera's frame; z of the direction is 1, so its parameter is the depth.
struct PixelLine {
  Vec3 at_zero;
  Vec3 direction;
};

PixelLine line_through(const world::Camera& camera, const Vec2& pixel) {
  const Vec2 plane = (pixel - camera.principal) / camera.focal;
  if (camera.projection == world::Projection::orthographic) return {Vec3(plane, 0), Vec3(0, 0, 1)};
  return {Vec3(0), Vec3(plane, 1)};
}

// One triangle with what it takes to answer for its pixels.
class Patch {
 public:
  Patch(const pan::Model& model, const world::Camera& camera, bool flat, const DrawItem& item,
        const Placement& placement, std::uint32_t triangle)
      : flat_(flat), front_(item.sides == Sides::front) {
    const pan::MeshView mesh = model.mesh(item.mesh);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t index = mesh.indices[std::size_t{3} * triangle + k];
      const auto& p = mesh.positions[index];
      const auto& n = mesh.normals[index];
      corner_[k] = Vec3(placement.camera_from_mesh * Vec4(p.x, p.y, p.z, 1));
      normal_[k] = placement.world_normal_from_mesh * Vec3(n.x, n.y, n.z);
    }
    edge_1_ = corner_[1] - corner_[0];
    edge_2_ = corner_[2] - corner_[0];
    outward_ = glm::cross(edge_1_, edge_2_) * (item.mirrored ? -1.0 : 1.0);
    geometric_ = unit_or_zero(camera.world_from_camera * outward_);
  }

  // weights of the three corners at the point that the line sees; footprint: metres that a pixel
  // spans there
  Vec3 weights(const PixelLine& line, double footprint) const {
    // the origin is moved next to the triangle first, so that a large distance cancels once
    const Vec3 start = line.at_zero + line.direction * corner_[0].z - corner_[0];
    const Vec3 p = glm::cross(line.direction, edge_2_);
    const double determinant = glm::dot(edge_1_, p);
    const double u = glm::dot(start, p) / determinant;
    const double v = glm::dot(line.direction, glm::cross(start, edge_1_)) / determinant;
    const Vec3 weight(1 - u - v, u, v);
    // also takes what is no number, from a triangle seen exactly edge on
    Vec3 inside;
    for (int k = 0; k < 3; ++k) inside[k] = weight[k] > 0 ? std::min(weight[k], 1e6) : 0.0;
    const double sum = inside.x + inside.y + inside.z;
    inside = sum > 0 ? inside / sum : Vec3(1.0 / 3);
    return std::fabs(depth(weight) - depth(inside)) <= footprint ? weight : inside;
  }

  double nearest() const {
    return std::max(0.0, std::min({corner_[0].z, corner_[1].z, corner_[2].z}));
  }

  double depth(const Vec3& weight) const {
    return weight.x * corner_[0].z + weight.y * corner_[1].z + weight.z * corner_[2].z;
  }

  Vec3 normal(const Vec3& weight, const PixelLine& line) const {
    const Vec3 smooth =
        flat_ ? geometric_
              : unit_or_zero(weight.x * normal_[0] + weight.y * normal_[1] + weight.z * normal_[2]);
    const bool away = !front_ && glm::dot(outward_, line.direction) > 0;
    return away ? -smooth : smooth;
  }

 private:
  static Vec3 unit_or_zero(const Vec3& v) {
    const double length = glm::length(v);
    return length > 0 ? v / length : Vec3(0);
  }

  bool flat_;
  bool front_;      // the back is not seen
  Vec3 corner_[3];  // camera frame
  Vec3 normal_[3];  // world
  Vec3 edge_1_, edge_2_;
  Vec3 outward_;    // camera frame, any length
  Vec3 geometric_;  // world, unit
};

}  // namespace

void set_truth_target(GroundTruthTarget& target, std::shared_ptr<const pan::Model> model,
                      std::shared_ptr<const std::vector<DrawItem>> items,
                      const VisibleTarget& visible, const world::Pose& pose) {
  target.model = std::move(model);
  target.items = std::move(items);
  target.target = visible.target;
  target.first_id = visible.first_id;
  target.placements.resize(target.items->size());
  const Mat3 rotation = glm::mat3_cast(pose.rotation);
  for (std::size_t k = 0; k < visible.items.size(); ++k) {
    Placement& placement = target.placements[visible.items[k]];
    const DrawItem& item = (*target.items)[visible.items[k]];
    placement.camera_from_mesh = visible.boxes[k].camera_from_mesh;
    placement.world_normal_from_mesh = rotation * item.model_normal_from_mesh;
  }
}

void fill_ground_truth(const world::Camera& camera, bool flat,
                       std::span<const GroundTruthTarget> targets, const Tile& tile,
                       std::span<const TriangleId> ids, image::Image& image) {
  const double focal = std::max(camera.focal.x, camera.focal.y);
  const bool perspective = camera.projection == world::Projection::perspective;
  const auto fill_row = [&](std::size_t row) {
    std::optional<Patch> patch;
    TriangleId last;
    const GroundTruthTarget* target = nullptr;
    const DrawItem* item = nullptr;
    for (std::size_t column = 0; column < tile.width; ++column) {
      const TriangleId id = ids[row * tile.width + column];
      const std::size_t x = tile.x + column;
      const std::size_t y = tile.y + row;
      const std::size_t pixel = y * image.width + x;
      if (id.item == 0) continue;
      if (id.item != last.item || id.triangle != last.triangle) {
        target =
            &*std::prev(std::upper_bound(targets.begin(), targets.end(), id.item,
                                         [](std::uint32_t value, const GroundTruthTarget& one) {
                                           return value <= one.first_id;
                                         }));
        const std::size_t index = id.item - target->first_id - 1;
        item = &(*target->items)[index];
        patch.emplace(*target->model, camera, flat, *item, target->placements[index], id.triangle);
      }
      last = id;
      const PixelLine line =
          line_through(camera, Vec2(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5));
      const Vec3 weight = patch->weights(line, (perspective ? patch->nearest() : 1) / focal);
      const double depth = patch->depth(weight);
      const Vec3 normal = patch->normal(weight, line);
      image.depth[pixel] = static_cast<float>(depth);
      image.range[pixel] =
          static_cast<float>(perspective ? depth * glm::length(line.direction) : depth);
      for (int k = 0; k < 3; ++k)
        image.normal[3 * pixel + static_cast<std::size_t>(k)] = static_cast<float>(normal[k]);
      image.target_id[pixel] = target->target + 1;
      // at any level of detail
      const pan::layout::Instance& instance = target->model->instances()[item->instance];
      image.node_id[pixel] = instance.node + 1;
      const std::int32_t back = item->sides == Sides::back
                                    ? target->model->back_of(item->instance)
                                    : static_cast<std::int32_t>(instance.material);
      image.material_id[pixel] = static_cast<std::uint32_t>(back) + 1;
    }
  };
  parallel_for(tile.height, std::ref(fill_row));
}

}  // namespace panwright::preview
