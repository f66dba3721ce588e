#include "studio/edges.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "studio/clip.h"
#include "world/evaluation.h"

namespace panwright::studio {
namespace {

struct ProjectedVertex {
  Vec2 pixel{0};
  double depth = 0;  // ≤ 0: behind the camera
};

class EdgeImage {
 public:
  EdgeImage(const world::Camera& camera, const image::Image& image)
      : camera_(camera), image_(image), edges_(image.pixels()), farthest_(image.pixels()) {
    // an edge may cross a pixel beside the point of the known depth
    const auto width = static_cast<std::ptrdiff_t>(image.width),
               height = static_cast<std::ptrdiff_t>(image.height);
    for (std::ptrdiff_t y = 0; y < height; ++y)
      for (std::ptrdiff_t x = 0; x < width; ++x) {
        float most = 0;
        for (std::ptrdiff_t v = std::max<std::ptrdiff_t>(y - 1, 0);
             v <= std::min(y + 1, height - 1); ++v)
          for (std::ptrdiff_t u = std::max<std::ptrdiff_t>(x - 1, 0);
               u <= std::min(x + 1, width - 1); ++u) {
            const auto at = static_cast<std::size_t>(v * width + u);
            if (image.target_id[at] > 0) most = std::max(most, image.depth[at]);
          }
        farthest_[static_cast<std::size_t>(y * width + x)] = most * 1.0001f;
      }
  }

  ProjectedVertex projected(const Vec3& p) const {
    if (camera_.distortion) {
      const auto place = camera_.distortion->place(p);
      return place ? ProjectedVertex{camera_.principal + camera_.focal * *place, p.z}
                   : ProjectedVertex{};
    }
    if (camera_.projection != world::Projection::perspective)
      return {camera_.principal + camera_.focal * Vec2(p.x, p.y), p.z};
    return {camera_.principal + camera_.focal * Vec2(p.x, p.y) / std::max(p.z, 1e-300), p.z};
  }

  // A line between points in camera axes, which a lens with distortion bends.
  void bent_line(const Vec3& from, const Vec3& to) {
    constexpr double kPiece = 8, kMostPieces = 256;  // pixels
    ProjectedVertex before = projected(from);
    const double length = glm::length(projected(to).pixel - before.pixel);
    const int pieces = static_cast<int>(std::clamp(std::ceil(length / kPiece), 1.0, kMostPieces));
    for (int k = 1; k <= pieces; ++k) {
      const ProjectedVertex next =
          projected(from + (to - from) * (static_cast<double>(k) / pieces));
      line(before, next);
      before = next;
    }
  }

  void line(ProjectedVertex a, ProjectedVertex b) {
    if (!(a.depth > 0 && b.depth > 0)) return;
    if (!clip(a, b)) return;
    const Vec2 way = b.pixel - a.pixel;
    const auto steps = static_cast<int>(std::ceil(std::max(std::fabs(way.x), std::fabs(way.y))));
    for (int i = 0; i <= steps; ++i) {
      const double t = steps > 0 ? static_cast<double>(i) / steps : 0;
      const Vec2 at = a.pixel + t * way;
      if (!(at.x >= 0 && at.y >= 0 && at.x < image_.width && at.y < image_.height)) continue;
      const auto pixel =
          static_cast<std::size_t>(at.y) * image_.width + static_cast<std::size_t>(at.x);
      // 1/z is linear in the image of a perspective camera
      const double depth = camera_.projection == world::Projection::perspective
                               ? 1 / ((1 - t) / a.depth + t / b.depth)
                               : (1 - t) * a.depth + t * b.depth;
      if (depth <= double{farthest_[pixel]}) edges_[pixel] = 255;
    }
  }

  std::vector<std::uint8_t> take() { return std::move(edges_); }

 private:
  // Clips a line to the image, with its depths.
  bool clip(ProjectedVertex& a, ProjectedVertex& b) const {
    const auto part = visible_part(a.pixel, b.pixel, Vec2(image_.width, image_.height));
    if (!part) return false;
    const Vec2 way = b.pixel - a.pixel;
    const auto at = [&](double t) {
      const double depth = camera_.projection == world::Projection::perspective
                               ? 1 / ((1 - t) / a.depth + t / b.depth)
                               : (1 - t) * a.depth + t * b.depth;
      return ProjectedVertex{a.pixel + t * way, depth};
    };
    const ProjectedVertex first = at(part->first), last = at(part->second);
    a = first;
    b = last;
    return true;
  }

  const world::Camera& camera_;
  const image::Image& image_;
  std::vector<std::uint8_t> edges_;
  std::vector<float> farthest_;
};

}  // namespace

std::vector<std::uint8_t> edges_of(const world::World& world, const world::Camera& camera,
                                   const image::Image& image, const Job& job) {
  EdgeImage image_edges(camera, image);
  const Mat3 camera_from_world = glm::transpose(glm::mat3_cast(camera.world_from_camera));
  std::vector<ProjectedVertex> vertices;
  std::vector<Vec3> points;  // the same in camera axes
  for (const world::Instance& target : world.instances()) {
    const auto state = world::evaluated(target);
    const pan::Model& model = *target.model();
    const Mat4 world_from_model = target.pose().matrix();
    for (const pan::layout::Instance& instance : model.instances()) {
      if (job.cancelled()) return {};
      if (state.node_visible[instance.node] == 0) continue;
      const Mat4 world_from_node = world_from_model * state.model_from_nodes[instance.node];
      const pan::layout::Mesh& record = model.meshes()[instance.mesh];
      const pan::MeshView mesh = model.mesh(instance.mesh);
      const Vec3 origin(record.origin[0], record.origin[1], record.origin[2]);
      vertices.clear();
      points.clear();
      for (const auto& p : mesh.positions) {
        const Vec3 place(world_from_node * Vec4(origin + Vec3(p.x, p.y, p.z), 1));
        points.push_back(camera_from_world * (place - camera.position));
        if (!camera.distortion) vertices.push_back(image_edges.projected(points.back()));
      }
      for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t a = mesh.indices[i + k], b = mesh.indices[i + (k + 1) % 3];
          if (camera.distortion)
            image_edges.bent_line(points[a], points[b]);
          else
            image_edges.line(vertices[a], vertices[b]);
        }
    }
  }
  return image_edges.take();
}

}  // namespace panwright::studio
