#include "geometry/ray/instances.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "geometry/ray/box_tree.h"
#include "geometry/ray/internal/mesh_search.h"

namespace panwright::geometry {
namespace {

// of the largest coordinate of a box: far more than its corners and the slabs round by, and than
// the search looks around a mesh
constexpr double kBoxSlack = 1e-5;
constexpr std::size_t kBundle = 16;  // rays that are searched together

struct Placed {
  const MeshSearch* mesh = nullptr;
  Vec3 translation{0};
  Mat3 mesh_from_world{1};
  bool asked = false;
};

bool is_regular(const Mat3& linear, const Mat3& inverse) {
  for (int column = 0; column < 3; ++column)
    if (!is_finite(inverse[column])) return false;
  // the product shows whether the inverse is accurate
  const Mat3 product = linear * inverse;
  double off = 0;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      off = std::max(off, std::fabs(product[column][row] - (column == row ? 1.0 : 0.0)));
  return off < 1e-6;
}

}  // namespace

struct InstanceCaster::Impl {
  std::vector<SearchMesh> meshes;
  std::vector<std::shared_ptr<MeshSearch>> unbuilt;  // of these, and of the flattened ones
  std::vector<Placed> placed;
  std::vector<SearchMesh> flattened;  // in world coordinates
  std::vector<AxisBox> boxes;         // one per placed, world; taken by the tree
  BoxTree tree;
  bool built = false;

  void search(SearchRay& ray, bool any) const;
  void search(std::span<SearchRay> rays) const;
};

SearchMesh search_mesh(std::vector<Vec3> positions, std::vector<Triangle> triangles,
                       const Job& job) {
  auto mesh = std::make_shared<MeshSearch>(std::move(positions), std::move(triangles));
  mesh->build(job);
  return mesh;
}

InstanceCaster::InstanceCaster() : impl_(std::make_unique<Impl>()) {}
InstanceCaster::~InstanceCaster() = default;
InstanceCaster::InstanceCaster(InstanceCaster&&) noexcept = default;
InstanceCaster& InstanceCaster::operator=(InstanceCaster&&) noexcept = default;

std::uint32_t InstanceCaster::add_mesh(std::span<const Vec3> positions,
                                       std::span<const Triangle> triangles) {
  impl_->unbuilt.push_back(
      std::make_shared<MeshSearch>(std::vector<Vec3>(positions.begin(), positions.end()),
                                   std::vector<Triangle>(triangles.begin(), triangles.end())));
  return add_mesh(impl_->unbuilt.back());
}

std::uint32_t InstanceCaster::add_mesh(SearchMesh mesh) {
  assert(mesh != nullptr);
  impl_->meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(impl_->meshes.size() - 1);
}

std::uint32_t InstanceCaster::add(std::uint32_t mesh, const Mat4& world_from_mesh, bool asked) {
  assert(!impl_->built && mesh < impl_->meshes.size());
  Placed placed;
  placed.mesh = impl_->meshes[mesh].get();
  placed.asked = asked;
  placed.translation = Vec3(world_from_mesh[3]);
  const Mat3 linear(world_from_mesh);
  placed.mesh_from_world = glm::inverse(linear);
  if (!is_regular(linear, placed.mesh_from_world)) {
    // flat, so that its frame has no inverse: it is kept in the world's
    std::vector<Vec3> positions;
    for (const Vec3& p : placed.mesh->positions())
      positions.push_back(Vec3(world_from_mesh * Vec4(p, 1)));
    impl_->unbuilt.push_back(
        std::make_shared<MeshSearch>(std::move(positions), placed.mesh->triangles()));
    impl_->flattened.push_back(impl_->unbuilt.back());
    placed.mesh = impl_->flattened.back().get();
    placed.translation = Vec3(0);
    placed.mesh_from_world = Mat3(1);
  }
  const bool in_world = placed.mesh != impl_->meshes[mesh].get();
  const Mat4 place = in_world ? Mat4(1) : world_from_mesh;
  const Vec3 low = placed.mesh->low();
  const Vec3 high = placed.mesh->high();
  AxisBox box;
  for (int corner = 0; corner < 8; ++corner)
    box.add(Vec3(place * Vec4(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y,
                              corner & 4 ? high.z : low.z, 1)));
  const Vec3 size = box.high - box.low;
  const Vec3 far = glm::max(glm::abs(box.high), glm::abs(box.low));
  const double slack =
      kBoxSlack * std::max({size.x, size.y, size.z}) + 1e-15 * std::max({far.x, far.y, far.z});
  box.widen(slack);
  assert(is_finite(box.low) && is_finite(box.high));
  impl_->placed.push_back(placed);
  impl_->boxes.push_back(placed.mesh->empty() ? AxisBox{} : box);
  return static_cast<std::uint32_t>(impl_->placed.size() - 1);
}

void InstanceCaster::build(const Job& job) {
  Impl& impl = *impl_;
  assert(!impl.built);
  parallel_for(
      impl.unbuilt.size(), [&](std::size_t i) { impl.unbuilt[i]->build(job); }, job);
  impl.unbuilt.clear();
  impl.tree.build(std::move(impl.boxes));
  impl.built = true;
}

void InstanceCaster::Impl::search(SearchRay& ray, bool any) const {
  assert(built);
  if (!(ray.max_distance >= ray.min_distance)) return;
  tree.search(ray.origin, ray.direction, ray.min_distance, ray.max_distance,
              [&](std::uint32_t index) {
                const Placed& one = placed[index];
                one.mesh->search(ray, one.mesh_from_world * (ray.origin - one.translation),
                                 one.mesh_from_world * ray.direction, index, one.asked, any);
                return any && ray.found;
              });
}

// Rays of one origin, the nearest hits of all.
void InstanceCaster::Impl::search(std::span<SearchRay> rays) const {
  assert(built);
  AxisBox directions;
  std::array<Vec3, kBundle> inverses;
  double from = rays[0].min_distance, to = rays[0].max_distance;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    directions.add(rays[i].direction);
    inverses[i] = BoxTree::inverse_of(rays[i].direction);
    from = std::min(from, rays[i].min_distance);
    to = std::max(to, rays[i].max_distance);
  }
  const Vec3& origin = rays[0].origin;
  tree.search(origin, directions, from, to, [&](std::uint32_t index) {
    const Placed& one = placed[index];
    const Vec3 start = one.mesh_from_world * (origin - one.translation);
    double farthest = from;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      SearchRay& ray = rays[i];
      if (tree.enters(index, origin, inverses[i], ray.min_distance, ray.max_distance))
        one.mesh->search(ray, start, one.mesh_from_world * ray.direction, index, one.asked, false);
      farthest = std::max(farthest, ray.max_distance);
    }
    to = farthest;
    return false;
  });
}

namespace {

SearchRay begun(const Ray& ray, const HitFilter& filter) {
  assert(std::fabs(glm::dot(ray.direction, ray.direction) - 1) < 1e-6);
  SearchRay search;
  search.origin = ray.origin;
  search.direction = ray.direction;
  search.min_distance = ray.min_distance;
  search.max_distance = ray.max_distance;
  search.filter = filter;
  return search;
}

}  // namespace

std::optional<InstanceHit> InstanceCaster::closest(const Ray& ray, const HitFilter& filter) const {
  SearchRay search = begun(ray, filter);
  impl_->search(search, false);
  if (!search.found) return std::nullopt;
  return search.best;
}

void InstanceCaster::closest(std::span<const Ray> rays, std::span<std::optional<InstanceHit>> hits,
                             const HitFilter& filter) const {
  assert(rays.size() == hits.size());
  std::array<SearchRay, kBundle> bundle;
  for (std::size_t first = 0; first < rays.size(); first += kBundle) {
    const std::size_t count = std::min(kBundle, rays.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      assert(rays[first + i].origin == rays[0].origin);
      bundle[i] = begun(rays[first + i], filter);
    }
    impl_->search(std::span(bundle).first(count));
    for (std::size_t i = 0; i < count; ++i)
      hits[first + i] = bundle[i].found ? std::optional(bundle[i].best) : std::nullopt;
  }
}

bool InstanceCaster::any(const Ray& ray, const HitFilter& filter) const {
  SearchRay search = begun(ray, filter);
  impl_->search(search, true);
  return search.found;
}

}  // namespace panwright::geometry
