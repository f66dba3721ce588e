#include "geometry/ray.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <new>
#include <vector>

#include "geometry/internal/embree_device.h"
#include "geometry/internal/hit_order.h"

namespace panwright::geometry {

namespace {

// The search runs in units of the set's radius. Positions there are off by at most 2^-24·√3 of it,
// origins and directions likewise; ten times that is safe.
constexpr double kSlack = 2e-6;

struct Placed {
  std::vector<Vec3> positions;  // V, world
  std::vector<Triangle> triangles;
  bool mirrored = false;
};

// One query on its way through the tree.
struct Query {
  RTCIntersectContext context;  // first: Embree hands back a pointer to it
  const std::vector<Placed>* instances;
  Vec3 origin;            // double, moved close to the set
  Vec3 direction;         // unit
  double moved;           // metres from the ray's origin to `origin`
  double min_distance;    // metres from the ray's origin
  double max_distance;    // metres
  double metres_to_unit;  // 1 / radius
  bool found;
  RayHit best;  // the normal is filled in at the end
};

double clamp01(double x) { return std::min(1.0, std::max(0.0, x)); }

// The triangle's own point that the ray meets, in double; off the triangle by rounding, the
// nearest one on it. Möller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997.
double intersect(const Query& query, const Vec3& a, const Vec3& b, const Vec3& c, float search_u,
                 float search_v, Vec2& barycentric) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 p = glm::cross(query.direction, ac);
  const double determinant = glm::dot(ab, p);
  const Vec3 s = query.origin - a;
  const Vec3 q = glm::cross(s, ab);
  double u = glm::dot(s, p) / determinant;
  double v = glm::dot(query.direction, q) / determinant;
  // edge-on, or not a number: the search's own answer is all there is
  if (!(std::fabs(u) < 2) || !(std::fabs(v) < 2)) {
    u = search_u;
    v = search_v;
  }
  if (u >= 0 && v >= 0 && u + v <= 1) {
    barycentric = {u, v};
    const double t = glm::dot(ac, q) / determinant;
    if (std::isfinite(t)) return t;
  }
  u = clamp01(u);
  v = clamp01(v);
  if (u + v > 1) {
    const double sum = u + v;
    u /= sum;
    v /= sum;
  }
  barycentric = {u, v};
  return glm::dot(a + u * ab + v * ac - query.origin, query.direction);
}

// Decides a candidate in double and remembers the best. False: out of range or no better.
bool take(Query& query, const RTCHit& hit) {
  const Placed& placed = (*query.instances)[hit.geomID];
  const Triangle& t = placed.triangles[hit.primID];
  RayHit candidate{};
  candidate.distance =
      query.moved + intersect(query, placed.positions[t[0]], placed.positions[t[1]],
                              placed.positions[t[2]], hit.u, hit.v, candidate.barycentric);
  candidate.instance = hit.geomID;
  candidate.triangle = hit.primID;
  if (!(candidate.distance >= query.min_distance && candidate.distance <= query.max_distance))
    return false;
  if (query.found && comes_after(candidate, query.best)) return false;
  query.best = candidate;
  query.found = true;
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
  auto& ray = *reinterpret_cast<RTCRay*>(arguments->ray);
  const double limit = (query.best.distance - query.moved) * query.metres_to_unit + kSlack;
  ray.tfar = std::max(ray.tnear, static_cast<float>(limit * (1 + kSlack)));
}

void filter_any(const RTCFilterFunctionNArguments* arguments) {
  auto& query = *reinterpret_cast<Query*>(arguments->context);
  if (!take(query, hit_of(arguments))) arguments->valid[0] = 0;
}

Vec3 unit(const Vec3& v) {
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  assert(largest > 0 && std::isfinite(largest));
  return glm::normalize(v / largest);
}

}  // namespace

struct RayCaster::Impl {
  std::vector<Placed> instances;
  RTCScene scene = nullptr;
  Vec3 centre{0};
  double radius = 0;  // of the ball about the bounds; 0: nothing to hit

  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
  }

  void measure();
  void attach(std::uint32_t instance);
  bool prepare(const Ray& ray, Query& query, RTCRay& search) const;
};

RayCaster::RayCaster() : impl_(std::make_unique<Impl>()) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

std::uint32_t RayCaster::add(const Mesh& mesh, const Mat4& world_from_mesh) {
  assert(impl_->scene == nullptr);
  Placed placed;
  placed.positions.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) {
    placed.positions.push_back(Vec3(world_from_mesh * Vec4(p, 1)));
    assert(is_finite(placed.positions.back()));
  }
  placed.triangles = mesh.triangles;
  placed.mirrored = glm::determinant(Mat3(world_from_mesh)) < 0;
  impl_->instances.push_back(std::move(placed));
  return static_cast<std::uint32_t>(impl_->instances.size() - 1);
}

void RayCaster::Impl::measure() {
  Vec3 low(0);
  Vec3 high(0);
  bool any = false;
  for (const Placed& placed : instances) {
    for (const Triangle& t : placed.triangles) {
      for (const std::uint32_t v : t) {
        assert(v < placed.positions.size());
        const Vec3& p = placed.positions[v];
        low = any ? glm::min(low, p) : p;
        high = any ? glm::max(high, p) : p;
        any = true;
      }
    }
  }
  centre = 0.5 * low + 0.5 * high;
  radius = any ? glm::length(0.5 * high - 0.5 * low) : 0;
}

void RayCaster::Impl::attach(std::uint32_t instance) {
  const Placed& placed = instances[instance];
  RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* positions = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), placed.positions.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              sizeof(Triangle), placed.triangles.size()));
  if (positions == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    throw std::bad_alloc();
  }
  for (const Vec3& p : placed.positions) {
    const Vec3 q = (p - centre) / radius;
    for (int axis = 0; axis < 3; ++axis) *positions++ = static_cast<float>(q[axis]);
  }
  for (const Triangle& t : placed.triangles) indices = std::copy(t.begin(), t.end(), indices);
  rtcSetGeometryIntersectFilterFunction(geometry, filter_closest);
  rtcSetGeometryOccludedFilterFunction(geometry, filter_any);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, instance);
  rtcReleaseGeometry(geometry);
}

void RayCaster::build() {
  Impl& impl = *impl_;
  assert(impl.scene == nullptr);
  impl.measure();
  impl.scene = rtcNewScene(embree_device());
  rtcSetSceneFlags(impl.scene, RTC_SCENE_FLAG_ROBUST);
  if (impl.radius > 0)
    for (std::uint32_t i = 0; i < impl.instances.size(); ++i)
      if (!impl.instances[i].triangles.empty()) impl.attach(i);
  rtcCommitScene(impl.scene);
  if (rtcGetDeviceError(embree_device()) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
}

// Moves the ray's start close to the set, in double. False: it passes by.
bool RayCaster::Impl::prepare(const Ray& ray, Query& query, RTCRay& search) const {
  assert(scene != nullptr);
  if (!(radius > 0) || !(ray.max_distance >= ray.min_distance)) return false;
  const Vec3 direction = unit(ray.direction);
  const Vec3 to_centre = centre - ray.origin;
  const double along = glm::dot(to_centre, direction);
  const Vec3 across = to_centre - along * direction;
  const double reach = radius * (1 + 2 * kSlack);
  if (!(glm::dot(across, across) <= reach * reach)) return false;
  // a little before the range, and no further away than the set
  const double slack = kSlack * radius;
  const double begin = std::max(ray.min_distance - slack, along - reach);
  const double end = std::min(ray.max_distance + slack, along + reach);
  if (!(end >= begin)) return false;

  rtcInitIntersectContext(&query.context);
  query.instances = &instances;
  query.direction = direction;
  query.moved = begin;
  query.origin = ray.origin + begin * direction;
  query.min_distance = ray.min_distance;
  query.max_distance = ray.max_distance;
  query.metres_to_unit = 1 / radius;
  query.found = false;

  // about the centre without the rounding of a far origin
  const Vec3 start = ((begin - along) * direction - across) / radius;
  search.org_x = static_cast<float>(start.x);
  search.org_y = static_cast<float>(start.y);
  search.org_z = static_cast<float>(start.z);
  search.dir_x = static_cast<float>(direction.x);
  search.dir_y = static_cast<float>(direction.y);
  search.dir_z = static_cast<float>(direction.z);
  search.tnear = 0;
  search.tfar = static_cast<float>((end - begin) / radius * (1 + kSlack) + kSlack);
  search.time = 0;
  search.mask = 0xffffffffu;
  search.id = 0;
  search.flags = 0;
  return true;
}

std::optional<RayHit> RayCaster::closest(const Ray& ray) const {
  Query query;
  RTCRayHit search{};
  if (!impl_->prepare(ray, query, search.ray)) return std::nullopt;
  search.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  search.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &query.context, &search);
  if (!query.found) return std::nullopt;
  const Placed& placed = impl_->instances[query.best.instance];
  const Triangle& t = placed.triangles[query.best.triangle];
  const Vec3& a = placed.positions[t[0]];
  const Vec3 normal = glm::cross(placed.positions[t[1]] - a, placed.positions[t[2]] - a);
  const double length = glm::length(normal);
  // a triangle without area has no side; what faces the ray is as good as any
  query.best.normal = length > 0 ? (placed.mirrored ? -normal : normal) / length : -query.direction;
  return query.best;
}

bool RayCaster::any(const Ray& ray) const {
  Query query;
  RTCRay search{};
  if (!impl_->prepare(ray, query, search)) return false;
  rtcOccluded1(impl_->scene, &query.context, &search);
  return query.found;
}

}  // namespace panwright::geometry
