#include "geometry/instances.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "geometry/internal/mesh_search.h"

namespace panwright::geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// of the largest coordinate of a box: far more than its corners and the slabs round by, and than
// the search looks around a mesh
constexpr double kBoxSlack = 1e-5;
constexpr std::size_t kLeaf = 2;  // instances

struct Box {
  Vec3 low{kInfinity};
  Vec3 high{-kInfinity};
  void add(const Vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  void add(const Box& box) {
    low = glm::min(low, box.low);
    high = glm::max(high, box.high);
  }
};

struct Placed {
  const MeshSearch* mesh = nullptr;
  Vec3 translation{0};
  Mat3 mesh_from_world{1};
  Box box;  // world
  bool asked = false;
};

// A box of the tree; children, or instances order[first, first + count).
struct Node {
  Box box;
  std::uint32_t first = 0;  // count 0: the left child; the right one follows it
  std::uint32_t count = 0;
};

// Distance at which a ray enters a box; infinity: not within [from, to].
double entry(const Box& box, const Vec3& origin, const Vec3& inverse, double from, double to) {
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.low[axis] - origin[axis]) * inverse[axis];
    const double b = (box.high[axis] - origin[axis]) * inverse[axis];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to ? from : kInfinity;
}

bool is_regular(const Mat3& linear, const Mat3& inverse) {
  for (int column = 0; column < 3; ++column)
    if (!is_finite(inverse[column])) return false;
  // the product says whether the inverse is worth anything
  const Mat3 product = linear * inverse;
  double off = 0;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      off = std::max(off, std::fabs(product[column][row] - (column == row ? 1.0 : 0.0)));
  return off < 1e-6;
}

}  // namespace

struct InstanceCaster::Impl {
  std::vector<std::unique_ptr<MeshSearch>> meshes;
  std::vector<std::unique_ptr<MeshSearch>> flattened;  // in world coordinates
  std::vector<Placed> placed;
  std::vector<std::uint32_t> order;
  std::vector<Node> nodes;  // 0: the root

  void split(std::uint32_t node, std::uint32_t begin, std::uint32_t end);
  void search(SearchRay& ray, bool any) const;
};

InstanceCaster::InstanceCaster() : impl_(std::make_unique<Impl>()) {}
InstanceCaster::~InstanceCaster() = default;
InstanceCaster::InstanceCaster(InstanceCaster&&) noexcept = default;
InstanceCaster& InstanceCaster::operator=(InstanceCaster&&) noexcept = default;

std::uint32_t InstanceCaster::add_mesh(std::span<const Vec3> positions,
                                       std::span<const Triangle> triangles) {
  impl_->meshes.push_back(
      std::make_unique<MeshSearch>(std::vector<Vec3>(positions.begin(), positions.end()),
                                   std::vector<Triangle>(triangles.begin(), triangles.end())));
  return static_cast<std::uint32_t>(impl_->meshes.size() - 1);
}

std::uint32_t InstanceCaster::add(std::uint32_t mesh, const Mat4& world_from_mesh, bool asked) {
  assert(impl_->nodes.empty() && mesh < impl_->meshes.size());
  Placed placed;
  placed.mesh = impl_->meshes[mesh].get();
  placed.asked = asked;
  placed.translation = Vec3(world_from_mesh[3]);
  const Mat3 linear(world_from_mesh);
  placed.mesh_from_world = glm::inverse(linear);
  if (!is_regular(linear, placed.mesh_from_world)) {
    // flat, so that rays have no place in its frame: it stands in the world's
    std::vector<Vec3> positions;
    for (const Vec3& p : placed.mesh->positions())
      positions.push_back(Vec3(world_from_mesh * Vec4(p, 1)));
    impl_->flattened.push_back(
        std::make_unique<MeshSearch>(std::move(positions), placed.mesh->triangles()));
    placed.mesh = impl_->flattened.back().get();
    placed.translation = Vec3(0);
    placed.mesh_from_world = Mat3(1);
  }
  const bool in_world = placed.mesh != impl_->meshes[mesh].get();
  const Mat4 place = in_world ? Mat4(1) : world_from_mesh;
  const Vec3 low = placed.mesh->low();
  const Vec3 high = placed.mesh->high();
  for (int corner = 0; corner < 8; ++corner)
    placed.box.add(Vec3(place * Vec4(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y,
                                     corner & 4 ? high.z : low.z, 1)));
  const Vec3 size = placed.box.high - placed.box.low;
  const Vec3 far = glm::max(glm::abs(placed.box.high), glm::abs(placed.box.low));
  const double slack =
      kBoxSlack * std::max({size.x, size.y, size.z}) + 1e-15 * std::max({far.x, far.y, far.z});
  placed.box.low -= slack;
  placed.box.high += slack;
  assert(is_finite(placed.box.low) && is_finite(placed.box.high));
  impl_->placed.push_back(placed);
  return static_cast<std::uint32_t>(impl_->placed.size() - 1);
}

// halves by the number of instances along the longest side of their centres
void InstanceCaster::Impl::split(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
  Box centres;
  const auto centre = [&](std::uint32_t i) {
    return 0.5 * placed[i].box.low + 0.5 * placed[i].box.high;
  };
  for (std::uint32_t i = begin; i < end; ++i) {
    nodes[node].box.add(placed[order[i]].box);
    centres.add(centre(order[i]));
  }
  if (end - begin <= kLeaf) {
    nodes[node].first = begin;
    nodes[node].count = end - begin;
    return;
  }
  const Vec3 size = centres.high - centres.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double first = centre(a)[axis];
                     const double second = centre(b)[axis];
                     return first != second ? first < second : a < b;
                   });
  const auto left = static_cast<std::uint32_t>(nodes.size());
  nodes[node].first = left;
  nodes.resize(nodes.size() + 2);
  split(left, begin, middle);
  split(left + 1, middle, end);
}

void InstanceCaster::build() {
  Impl& impl = *impl_;
  assert(impl.nodes.empty());
  std::vector<MeshSearch*> all;
  for (auto* list : {&impl.meshes, &impl.flattened})
    for (auto& mesh : *list) all.push_back(mesh.get());
  parallel_for(all.size(), [&](std::size_t i) { all[i]->build(); });
  for (std::uint32_t i = 0; i < impl.placed.size(); ++i)
    if (!impl.placed[i].mesh->empty()) impl.order.push_back(i);
  impl.nodes.resize(1);
  impl.split(0, 0, static_cast<std::uint32_t>(impl.order.size()));
}

void InstanceCaster::Impl::search(SearchRay& ray, bool any) const {
  assert(!nodes.empty());
  if (order.empty() || !(ray.max_distance >= ray.min_distance)) return;
  Vec3 inverse;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = ray.direction[axis];
    // finite, so that 0 times it is a number on the face of a box
    inverse[axis] = 1 / (std::fabs(d) < 1e-300 ? std::copysign(1e-300, d) : d);
  }
  struct Waiting {
    std::uint32_t node;
    double entry;
  };
  // note: the tree is halved at each level, so 2^32 instances need no more
  std::array<Waiting, 40> waiting;
  std::size_t count = 0;
  const auto visit = [&](std::uint32_t node) {
    return entry(nodes[node].box, ray.origin, inverse, ray.min_distance, ray.max_distance);
  };
  const double first = visit(0);
  if (first < kInfinity) waiting[count++] = {0, first};
  while (count > 0) {
    const Waiting next = waiting[--count];
    if (next.entry > ray.max_distance) continue;
    const Node& node = nodes[next.node];
    if (node.count == 0) {
      Waiting near{node.first, visit(node.first)};
      Waiting far{node.first + 1, visit(node.first + 1)};
      if (far.entry < near.entry) std::swap(near, far);
      if (far.entry < kInfinity) waiting[count++] = far;
      if (near.entry < kInfinity) waiting[count++] = near;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Placed& one = placed[order[i]];
      if (node.count > 1 &&
          entry(one.box, ray.origin, inverse, ray.min_distance, ray.max_distance) == kInfinity)
        continue;
      one.mesh->search(ray, one.mesh_from_world * (ray.origin - one.translation),
                       one.mesh_from_world * ray.direction, order[i], one.asked, any);
      if (any && ray.found) return;
    }
  }
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

bool InstanceCaster::any(const Ray& ray, const HitFilter& filter) const {
  SearchRay search = begun(ray, filter);
  impl_->search(search, true);
  return search.found;
}

}  // namespace panwright::geometry
