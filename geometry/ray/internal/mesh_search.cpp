#include "geometry/ray/internal/mesh_search.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include "base/axis_box.h"
#include "geometry/ray/internal/embree_device.h"
#include "geometry/ray/internal/hit_order.h"
#include "geometry/ray/internal/ray_triangle.h"

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace panwright::geometry {
namespace {

// Embree's threads are ordered with ours by means that ThreadSanitizer cannot see.
void tell_before([[maybe_unused]] const MeshSearch* mesh) {
#ifdef __SANITIZE_THREAD__
  __tsan_release(const_cast<MeshSearch*>(mesh));
#endif
}
void tell_after([[maybe_unused]] const MeshSearch* mesh) {
#ifdef __SANITIZE_THREAD__
  __tsan_acquire(const_cast<MeshSearch*>(mesh));
#endif
}

// The search for boxes is single precision, in units of the mesh's radius. Origins, directions and
// boxes there are off by at most 2^-24·√3 of a few units; ten times that is safe.
constexpr float kSlack = 2e-6f;

// A ray on its way through one mesh.
struct Query {
  RTCIntersectContext context;  // first: Embree hands back a pointer to it
  const MeshSearch* mesh;
  SearchRay* ray;
  internal::ShearedRay sheared;  // mesh frame, moved next to the mesh, unit
  double moved;                  // mesh metres from the ray's origin to the sheared one's
  double stretch;                // mesh metres for each world metre along the ray
  double shrink;                 // 1 / stretch
  double first;                  // where the ray begins, mesh metres from the sheared origin
  double to_search;              // 1 / radius
  std::uint32_t instance;
  bool asked;
};

// Decides a candidate and remembers the best. False: no hit, or no better.
bool take(Query& query, const MeshSearch::Leaf& leaf, std::uint32_t number) {
  SearchRay& ray = *query.ray;
  const Triangle& t = leaf.triangles[number];
  const std::vector<Vec3>& positions = query.mesh->positions();
  internal::Crossing crossing;
  if (!cross(query.sheared, positions[t[0]], positions[t[1]], positions[t[2]], query.first,
             crossing))
    return false;
  InstanceHit candidate;
  candidate.distance = (query.moved + crossing.along) * query.shrink;
  candidate.instance = query.instance;
  candidate.triangle = leaf.first + number;
  candidate.barycentric = crossing.barycentric;
  candidate.front = crossing.front;
  if (!(candidate.distance >= ray.min_distance && candidate.distance <= ray.max_distance))
    return false;
  if (ray.found && comes_after(candidate, ray.best)) return false;
  if (query.asked && ray.filter.counts && !ray.filter.counts(ray.filter.data, candidate))
    return false;
  ray.best = candidate;
  ray.max_distance = candidate.distance;
  ray.found = true;
  return true;
}

void find_closest(const RTCIntersectFunctionNArguments* arguments) {
  assert(arguments->N == 1);
  auto& query = *reinterpret_cast<Query*>(arguments->context);
  bool found = false;
  const MeshSearch::Leaf& leaf = query.mesh->leaf(arguments->primID);
  for (std::uint32_t i = 0; i < leaf.count; ++i) found |= take(query, leaf, i);
  if (!found) return;
  // what lies behind the hit by no more than rounding is still to be compared
  auto& search = reinterpret_cast<RTCRayHit*>(arguments->rayhit)->ray;
  const double limit =
      (query.ray->best.distance * query.stretch - query.moved) * query.to_search + kSlack;
  search.tfar =
      std::min(search.tfar, std::max(search.tnear, static_cast<float>(limit * (1 + kSlack))));
}

void find_any(const RTCOccludedFunctionNArguments* arguments) {
  assert(arguments->N == 1);
  auto& query = *reinterpret_cast<Query*>(arguments->context);
  const MeshSearch::Leaf& leaf = query.mesh->leaf(arguments->primID);
  for (std::uint32_t i = 0; i < leaf.count; ++i) {
    if (!take(query, leaf, i)) continue;
    reinterpret_cast<RTCRay*>(arguments->ray)->tfar = -std::numeric_limits<float>::infinity();
    return;
  }
}

}  // namespace

MeshSearch::MeshSearch(std::vector<Vec3> positions, std::vector<Triangle> triangles)
    : positions_(std::move(positions)), triangles_(std::move(triangles)) {
  bool any = false;
  for (const Triangle& t : triangles_)
    for (const std::uint32_t v : t) {
      assert(v < positions_.size());
      const Vec3& p = positions_[v];
      assert(is_finite(p));
      low_ = any ? glm::min(low_, p) : p;
      high_ = any ? glm::max(high_, p) : p;
      any = true;
    }
  centre_ = 0.5 * low_ + 0.5 * high_;
  radius_ = any ? glm::length(0.5 * high_ - 0.5 * low_) : 0;
  to_search_ = 1 / radius_;
}

MeshSearch::~MeshSearch() {
  if (scene_ != nullptr) rtcReleaseScene(scene_);
}

// Into how many slices a leaf is cut: as many as its box is larger than its triangles. Ernst and
// Greiner, "Early split clipping for bounding volume hierarchies", 2007.
std::uint8_t MeshSearch::slices_of(const Leaf& leaf) const {
  constexpr double kLoose = 16;
  // a million leaves, or two for each triangle
  const double most = std::clamp(1e6 / static_cast<double>(triangles_.size()), 2.0, 64.0);
  AxisBox bounds;
  double area = 0;
  for (std::uint32_t i = 0; i < leaf.count; ++i) {
    const Triangle& t = triangles_[leaf.first + i];
    for (const std::uint32_t v : t) bounds.add(positions_[v]);
    const Vec3& a = positions_[t[0]];
    area += glm::length(glm::cross(positions_[t[1]] - a, positions_[t[2]] - a));
  }
  const Vec3 size = bounds.extent();
  const double box = size.x * size.y + size.y * size.z + size.z * size.x;
  if (!(box > kLoose * area)) return 1;
  return static_cast<std::uint8_t>(box < most * area ? box / area : most);
}

// Two triangles in one leaf cost less than two leaves; most lists give neighbours one after the
// other.
void MeshSearch::list_leaves() {
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    Leaf leaf{.first = i};
    if (i + 1 < triangles_.size()) {
      int common = 0;
      for (const std::uint32_t v : triangles_[i])
        common += std::count(triangles_[i + 1].begin(), triangles_[i + 1].end(), v) > 0;
      if (common >= 2) {
        leaf.count = 2;
        ++i;
      }
    }
    for (std::uint32_t k = 0; k < leaf.count; ++k) leaf.triangles[k] = triangles_[leaf.first + k];
    leaf.slices = slices_of(leaf);
    for (leaf.slice = 0; leaf.slice < leaf.slices; ++leaf.slice) leaves_.push_back(leaf);
  }
}

void MeshSearch::bound(const RTCBoundsFunctionArguments* arguments) {
  const auto& mesh = *static_cast<const MeshSearch*>(arguments->geometryUserPtr);
  tell_after(&mesh);
  const Leaf& leaf = mesh.leaves_[arguments->primID];
  AxisBox box;
  const auto each_corner = [&](const auto& body) {
    for (std::uint32_t i = 0; i < leaf.count; ++i)
      for (int k = 0; k < 3; ++k) {
        const Triangle& t = mesh.triangles_[leaf.first + i];
        body(mesh.positions_[t[static_cast<std::size_t>(k)]],
             mesh.positions_[t[static_cast<std::size_t>((k + 1) % 3)]]);
      }
  };
  each_corner([&](const Vec3& a, const Vec3&) { box.add(a); });
  if (leaf.slices > 1) {
    const Vec3 size = box.extent();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const double from = box.low[axis] + size[axis] * leaf.slice / leaf.slices;
    const double to = box.low[axis] + size[axis] * (leaf.slice + 1) / leaf.slices;
    box = {};
    // the edges within the slice bound what lies in it
    each_corner([&](const Vec3& a, const Vec3& b) {
      const double rise = b[axis] - a[axis];
      double s = rise != 0 ? (from - a[axis]) / rise : 0;
      double e = rise != 0 ? (to - a[axis]) / rise : 1;
      if (s > e) std::swap(s, e);
      if (rise == 0 && (a[axis] < from || a[axis] > to)) return;
      s = std::max(s, 0.0);
      e = std::min(e, 1.0);
      if (s > e) return;
      for (const double w : {s, e}) box.add(a + w * (b - a));
    });
    box.low[axis] = from;
    box.high[axis] = to;
  }
  const Vec3 low = (box.low - mesh.centre_) / mesh.radius_;
  const Vec3 high = (box.high - mesh.centre_) / mesh.radius_;
  RTCBounds& bounds = *arguments->bounds_o;
  bounds.lower_x = static_cast<float>(low.x) - kSlack;
  bounds.lower_y = static_cast<float>(low.y) - kSlack;
  bounds.lower_z = static_cast<float>(low.z) - kSlack;
  bounds.upper_x = static_cast<float>(high.x) + kSlack;
  bounds.upper_y = static_cast<float>(high.y) + kSlack;
  bounds.upper_z = static_cast<float>(high.z) + kSlack;
  tell_before(&mesh);
}

void MeshSearch::build(const Job& job) {
  if (empty() || scene_ != nullptr) return;
  job.poll();
  leaves_.clear();
  list_leaves();
  job.poll();
  RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(leaves_.size()));
  rtcSetGeometryUserData(geometry, this);
  rtcSetGeometryBoundsFunction(geometry, bound, nullptr);
  rtcSetGeometryIntersectFunction(geometry, find_closest);
  rtcSetGeometryOccludedFunction(geometry, find_any);
  rtcCommitGeometry(geometry);
  scene_ = rtcNewScene(embree_device());
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometryByID(scene_, geometry, 0);
  rtcReleaseGeometry(geometry);
  if (job.state())
    rtcSetSceneProgressMonitorFunction(
        scene_, [](void* of, double) { return !static_cast<const Job*>(of)->cancelled(); },
        const_cast<Job*>(&job));
  tell_before(this);
  rtcCommitScene(scene_);
  tell_after(this);
  rtcSetSceneProgressMonitorFunction(scene_, nullptr, nullptr);
  if (job.cancelled()) {
    // whether or not the tree came to its end
    static_cast<void>(rtcGetDeviceError(embree_device()));
    rtcReleaseScene(std::exchange(scene_, nullptr));
    throw Cancelled();
  }
  if (rtcGetDeviceError(embree_device()) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
}

void MeshSearch::search(SearchRay& ray, const Vec3& origin, const Vec3& direction,
                        std::uint32_t instance, bool asked, bool any) const {
  const double stretch = glm::length(direction);
  if (empty() || !(stretch > 0) || !std::isfinite(stretch)) return;
  const double shrink = 1 / stretch;
  const Vec3 unit = direction * shrink;
  const Vec3 to_centre = centre_ - origin;
  const double along = glm::dot(to_centre, unit);
  const Vec3 across = to_centre - along * unit;
  const double reach = radius_ * (1 + 2 * kSlack);
  if (!(glm::dot(across, across) <= reach * reach)) return;
  // a little before the range, and no further away than the mesh
  const double slack = kSlack * radius_;
  const double begin = std::max(ray.min_distance * stretch - slack, along - reach);
  const double end = std::min(ray.max_distance * stretch + slack, along + reach);
  if (!(end >= begin)) return;
  // about the centre without the rounding of a far origin
  const Vec3 start = (begin - along) * unit - across;

  Query query;
  rtcInitIntersectContext(&query.context);
  query.mesh = this;
  query.ray = &ray;
  query.sheared = {centre_ + start, unit};
  query.moved = begin;
  query.stretch = stretch;
  query.shrink = shrink;
  query.first = ray.min_distance * stretch - begin;
  query.to_search = to_search_;
  query.instance = instance;
  query.asked = asked;

  RTCRayHit found{};
  RTCRay& search = found.ray;
  search.org_x = static_cast<float>(start.x * query.to_search);
  search.org_y = static_cast<float>(start.y * query.to_search);
  search.org_z = static_cast<float>(start.z * query.to_search);
  search.dir_x = static_cast<float>(unit.x);
  search.dir_y = static_cast<float>(unit.y);
  search.dir_z = static_cast<float>(unit.z);
  search.tfar = static_cast<float>((end - begin) * query.to_search * (1 + kSlack) + kSlack);
  search.mask = 0xffffffffu;
  if (any) {
    rtcOccluded1(scene_, &query.context, &search);
  } else {
    found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    found.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &query.context, &found);
  }
}

}  // namespace panwright::geometry
