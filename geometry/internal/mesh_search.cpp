#include "geometry/internal/mesh_search.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <new>

#include "geometry/internal/embree_device.h"
#include "geometry/internal/hit_order.h"

namespace panwright::geometry {
namespace {

// The search runs in units of the mesh's radius. Positions there are off by at most 2^-24·√3 of it,
// origins and directions likewise; ten times that is safe.
constexpr double kSlack = 2e-6;
// sine of the angle between ray and plane below which a triangle is seen edge on: what rounding of
// the determinant is worth
constexpr double kEdgeOn = 1e-14;

// A ray on its way through one mesh.
struct Query {
  RTCIntersectContext context;  // first: Embree hands back a pointer to it
  const std::vector<Vec3>* positions;
  const std::vector<Triangle>* triangles;
  SearchRay* ray;
  Vec3 origin;       // mesh frame, moved next to the mesh
  Vec3 direction;    // mesh frame, unit
  double moved;      // mesh metres from the ray's origin to `origin`
  double stretch;    // mesh metres for each world metre along the ray
  double reach;      // kSlack in mesh metres
  double to_search;  // 1 / radius
  std::uint32_t instance;
  bool asked;
};

double clamp01(double x) { return std::min(1.0, std::max(0.0, x)); }

struct Crossing {
  double along = 0;  // mesh metres from the query's origin
  Vec2 barycentric{0};
  bool front = true;
};

// Möller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997; just off the
// triangle, its nearest point.
bool cross(const Query& query, const Triangle& triangle, Crossing& crossing) {
  const std::vector<Vec3>& positions = *query.positions;
  const Vec3 a = positions[triangle[0]];
  const Vec3 ab = positions[triangle[1]] - a;
  const Vec3 ac = positions[triangle[2]] - a;
  const Vec3 p = glm::cross(query.direction, ac);
  const double determinant = glm::dot(ab, p);
  if (!(determinant * determinant > kEdgeOn * kEdgeOn * glm::dot(ab, ab) * glm::dot(ac, ac)))
    return false;
  const double inverse = 1 / determinant;
  const Vec3 s = query.origin - a;
  const Vec3 q = glm::cross(s, ab);
  const double u = glm::dot(s, p) * inverse;
  const double v = glm::dot(query.direction, q) * inverse;
  const double along = glm::dot(ac, q) * inverse;
  crossing.front = determinant > 0;
  if (u >= 0 && v >= 0 && u + v <= 1) {
    crossing.barycentric = {u, v};
    crossing.along = along;
    return std::isfinite(along);
  }
  // the side of the plane on which the ray begins decides, also next to the triangle
  if (!(query.moved + along >= query.ray->min_distance * query.stretch)) return false;
  double inside_u = clamp01(u);
  double inside_v = clamp01(v);
  if (inside_u + inside_v > 1) {
    const double sum = inside_u + inside_v;
    inside_u /= sum;
    inside_v /= sum;
  }
  const Vec3 nearest = inside_u * ab + inside_v * ac - s;
  const double nearest_along = glm::dot(nearest, query.direction);
  const Vec3 off = nearest - nearest_along * query.direction;
  if (!(glm::dot(off, off) <= query.reach * query.reach)) return false;
  crossing.barycentric = {inside_u, inside_v};
  crossing.along = nearest_along;
  return true;
}

// Decides a candidate in double and remembers the best. False: no hit, or no better.
bool take(Query& query, const RTCHit& hit) {
  SearchRay& ray = *query.ray;
  Crossing crossing;
  if (!cross(query, (*query.triangles)[hit.primID], crossing)) return false;
  InstanceHit candidate;
  candidate.distance = (query.moved + crossing.along) / query.stretch;
  candidate.instance = query.instance;
  candidate.triangle = hit.primID;
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

RTCHit hit_of(const RTCFilterFunctionNArguments* arguments) {
  assert(arguments->N == 1);
  return *reinterpret_cast<const RTCHit*>(arguments->hit);
}

void filter_closest(const RTCFilterFunctionNArguments* arguments) {
  auto& query = *reinterpret_cast<Query*>(arguments->context);
  if (!take(query, hit_of(arguments))) {
    arguments->valid[0] = 0;
    return;
  }
  // what lies behind the hit by no more than rounding is still to be compared
  auto& search = *reinterpret_cast<RTCRay*>(arguments->ray);
  const double limit =
      (query.ray->best.distance * query.stretch - query.moved) * query.to_search + kSlack;
  search.tfar = std::max(search.tnear, static_cast<float>(limit * (1 + kSlack)));
}

void filter_any(const RTCFilterFunctionNArguments* arguments) {
  auto& query = *reinterpret_cast<Query*>(arguments->context);
  if (!take(query, hit_of(arguments))) arguments->valid[0] = 0;
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
}

MeshSearch::~MeshSearch() {
  if (scene_ != nullptr) rtcReleaseScene(scene_);
}

void MeshSearch::build() {
  if (empty() || scene_ != nullptr) return;
  RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* positions = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), positions_.size()));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), triangles_.size()));
  if (positions == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    throw std::bad_alloc();
  }
  for (const Vec3& p : positions_) {
    // corners that no triangle has may lie anywhere
    const Vec3 q = glm::clamp((p - centre_) / radius_, Vec3(-2), Vec3(2));
    for (int axis = 0; axis < 3; ++axis) *positions++ = static_cast<float>(q[axis]);
  }
  for (const Triangle& t : triangles_) indices = std::copy(t.begin(), t.end(), indices);
  rtcSetGeometryIntersectFilterFunction(geometry, filter_closest);
  rtcSetGeometryOccludedFilterFunction(geometry, filter_any);
  rtcCommitGeometry(geometry);
  scene_ = rtcNewScene(embree_device());
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometryByID(scene_, geometry, 0);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
  if (rtcGetDeviceError(embree_device()) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
}

void MeshSearch::search(SearchRay& ray, const Vec3& origin, const Vec3& direction,
                        std::uint32_t instance, bool asked, bool any) const {
  const double stretch = glm::length(direction);
  if (empty() || !(stretch > 0) || !std::isfinite(stretch)) return;
  const Vec3 unit = direction / stretch;
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
  query.positions = &positions_;
  query.triangles = &triangles_;
  query.ray = &ray;
  query.origin = centre_ + start;
  query.direction = unit;
  query.moved = begin;
  query.stretch = stretch;
  query.reach = slack;
  query.to_search = 1 / radius_;
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
