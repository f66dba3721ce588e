#include "geometry/ray/ray.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "geometry/ray/internal/mesh_search.h"

namespace panwright::geometry {

namespace {

Vec3 unit(const Vec3& v) {
  const double squared = glm::dot(v, v);
  if (squared > 1e-200 && squared < 1e200) return v * (1 / std::sqrt(squared));
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  assert(largest > 0 && std::isfinite(largest));
  return glm::normalize(v / largest);
}

}  // namespace

// All meshes as one, in the world.
struct RayCaster::Impl {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> first;  // triangle of each instance
  std::vector<char> mirrored;        // of each instance
  std::unique_ptr<MeshSearch> mesh;  // takes the lists

  bool search(const Ray& ray, bool any, SearchRay& found) const;
};

RayCaster::RayCaster() : impl_(std::make_unique<Impl>()) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

std::uint32_t RayCaster::add(const Mesh& mesh, const Mat4& world_from_mesh) {
  assert(impl_->mesh == nullptr);
  const auto base = static_cast<std::uint32_t>(impl_->positions.size());
  for (const Vec3& p : mesh.positions) {
    impl_->positions.push_back(Vec3(world_from_mesh * Vec4(p, 1)));
    assert(is_finite(impl_->positions.back()));
  }
  impl_->first.push_back(static_cast<std::uint32_t>(impl_->triangles.size()));
  for (const Triangle& t : mesh.triangles)
    impl_->triangles.push_back({base + t[0], base + t[1], base + t[2]});
  impl_->mirrored.push_back(glm::determinant(Mat3(world_from_mesh)) < 0 ? 1 : 0);
  return static_cast<std::uint32_t>(impl_->first.size() - 1);
}

void RayCaster::build() {
  assert(impl_->mesh == nullptr);
  impl_->mesh =
      std::make_unique<MeshSearch>(std::move(impl_->positions), std::move(impl_->triangles));
  impl_->mesh->build();
}

bool RayCaster::Impl::search(const Ray& ray, bool any, SearchRay& found) const {
  assert(mesh != nullptr);
  if (!(ray.max_distance >= ray.min_distance)) return false;
  found.origin = ray.origin;
  found.direction = unit(ray.direction);
  found.min_distance = ray.min_distance;
  found.max_distance = ray.max_distance;
  mesh->search(found, found.origin, found.direction, 0, false, any);
  return found.found;
}

std::optional<RayHit> RayCaster::closest(const Ray& ray) const {
  SearchRay found;
  if (!impl_->search(ray, false, found)) return std::nullopt;
  const std::uint32_t triangle = found.best.triangle;
  const auto next = std::upper_bound(impl_->first.begin(), impl_->first.end(), triangle);
  RayHit hit{};
  hit.distance = found.best.distance;
  hit.instance = static_cast<std::uint32_t>(next - impl_->first.begin() - 1);
  hit.triangle = triangle - impl_->first[hit.instance];
  hit.barycentric = found.best.barycentric;
  const Triangle& t = impl_->mesh->triangles()[triangle];
  const std::vector<Vec3>& positions = impl_->mesh->positions();
  const Vec3& a = positions[t[0]];
  const Vec3 normal = glm::cross(positions[t[1]] - a, positions[t[2]] - a);
  const double length = glm::length(normal);
  // a triangle without area has no side; what faces the ray is as good as any
  hit.normal =
      length > 0 ? (impl_->mirrored[hit.instance] ? -normal : normal) / length : -found.direction;
  return hit;
}

bool RayCaster::any(const Ray& ray) const {
  SearchRay found;
  return impl_->search(ray, true, found);
}

}  // namespace panwright::geometry
