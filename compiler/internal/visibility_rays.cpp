#include "compiler/internal/visibility_rays.h"

#include <bit>
#include <cmath>
#include <tuple>

#include "base/parallel.h"

namespace panwright::compiler::internal {

namespace {

using geometry::InstanceHit;

constexpr std::size_t kChunk = 2048;  // rays that a thread takes at once
// sine of the angle between surfaces that are at the same depth over more than a line
constexpr double kParallel = 1e-3;
// of the radius: a ray passes an edge on the side where double says it does
constexpr double kRounding = 1e-12;
// of the radius: farther than what a search in single precision may be wrong by (2e-6)
constexpr double kAside = 3e-6;
// unit vectors a third of a turn apart
const Vec2 kThirds[] = {
    {0.8, 0.6}, {-0.9196152422706632, 0.39282032302755}, {0.1196152422706632, -0.99282032302755}};
// of the rays from outside, one in so many looks for surfaces at the same depth
constexpr std::uint32_t kShare = 8;

}  // namespace

// What a ray hit.
struct VisibilityRays::Hits {
  static constexpr std::size_t kMost = 64;
  std::array<InstanceHit, kMost> list;
  std::size_t count = 0;
  const WorldTriangles* model = nullptr;
  bool opaque_count = false;
};

std::pair<std::vector<std::uint32_t>, std::uint32_t> unique_positions(
    const std::vector<Vec3>& positions) {
  const std::size_t count = positions.size();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(count);
  for (std::uint32_t v = 0; v < count; ++v) {
    std::uint64_t h = 0x9e3779b97f4a7c15ull;  // 2^64 / golden ratio
    for (int axis = 0; axis < 3; ++axis) {
      h ^= std::bit_cast<std::uint64_t>(positions[v][axis] + 0.0);
      h *= 0xff51afd7ed558ccdull;  // MurmurHash3's 64-bit finaliser
      h ^= h >> 32;
    }
    order[v] = {h, v};
  }
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> unique(count);
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < count; ++i) {
    number += i > 0 && (order[i].first != order[i - 1].first ||
                        positions[order[i].second] != positions[order[i - 1].second]);
    unique[order[i].second] = number;
  }
  return {std::move(unique), number + 1};
}

std::array<Vec3, 2> perpendiculars(const Vec3& direction) {
  const Vec3 other = std::fabs(direction.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const Vec3 right = glm::normalize(glm::cross(direction, other));
  return {right, glm::cross(direction, right)};
}

VisibilityRays::VisibilityRays(WorldTriangles model, const Job& job)
    : model_(std::move(model)),
      job_(job),
      hit_(2 * model_.triangles.size()),
      ray_(model_.triangles.size()) {}

bool VisibilityRays::prepare() {
  if (model_.triangles.empty()) return false;
  Vec3 low(HUGE_VAL);
  Vec3 high(-HUGE_VAL);
  for (const geometry::Triangle& t : model_.triangles)
    for (const std::uint32_t v : t) {
      low = glm::min(low, model_.positions[v]);
      high = glm::max(high, model_.positions[v]);
    }
  centre_ = 0.5 * low + 0.5 * high;
  radius_ = glm::length(0.5 * high - 0.5 * low);
  if (!(radius_ > 0)) return false;
  has_transparent_ = std::find(model_.transparent.begin(), model_.transparent.end(), 1) !=
                     model_.transparent.end();
  caster_.add(caster_.add_mesh(model_.positions, model_.triangles), Mat4(1), true);
  caster_.build(job_);
  list_neighbours();
  return true;
}

// ---- adjacency and triangles

// Triangles by the unique positions of their corners, as compressed rows.
void VisibilityRays::list_neighbours() {
  std::uint32_t unique = 0;
  std::tie(position_, unique) = unique_positions(model_.positions);
  start_.assign(std::size_t{unique} + 2, 0);
  for (const geometry::Triangle& t : model_.triangles)
    for (const std::uint32_t v : t) ++start_[position_[v] + 2];
  for (std::size_t i = 2; i < start_.size(); ++i) start_[i] += start_[i - 1];
  around_.resize(start_.back());
  for (std::uint32_t i = 0; i < model_.triangles.size(); ++i)
    for (const std::uint32_t v : model_.triangles[i]) around_[start_[position_[v] + 1]++] = i;
}

std::array<Vec3, 3> VisibilityRays::corners(std::uint32_t triangle) const {
  const geometry::Triangle& t = model_.triangles[triangle];
  return {model_.positions[t[0]], model_.positions[t[1]], model_.positions[t[2]]};
}

Vec3 VisibilityRays::normal(std::uint32_t triangle) const {
  const auto [a, b, c] = corners(triangle);
  const Vec3 cross = glm::cross(b - a, c - a);
  const double length = glm::length(cross);
  return length > 0 ? cross / length : Vec3(0);
}

double VisibilityRays::area(std::uint32_t triangle) const {
  const auto [a, b, c] = corners(triangle);
  return 0.5 * glm::length(glm::cross(b - a, c - a));
}

int VisibilityRays::common_corners(std::uint32_t a, std::uint32_t b) const {
  int common = 0;
  for (const std::uint32_t i : model_.triangles[a])
    for (const std::uint32_t j : model_.triangles[b]) common += position_[i] == position_[j];
  return common;
}

// ---- one ray

OutsideRay VisibilityRays::ray_through(const Vec3& point, const Vec3& inwards) const {
  const double back = glm::dot(point - centre_, inwards) + 2 * radius_;
  return {point - back * inwards, inwards};
}

// The round in which a side of a triangle was hit first; 0: none.
std::atomic<std::uint16_t>& VisibilityRays::first_round(const InstanceHit& hit) {
  return hit_[2 * std::size_t{hit.triangle} + (hit.front ? 0 : 1)];
}

bool VisibilityRays::was_hit_before(const InstanceHit& hit) {
  const std::uint16_t round = first_round(hit).load(std::memory_order_relaxed);
  return round != 0 && round != round_;
}

// A filter of hits: remembers each, and lets rays pass what is transparent.
bool VisibilityRays::remember(const void* data, const InstanceHit& hit) {
  auto& hits = *static_cast<Hits*>(const_cast<void*>(data));
  if (hits.count < Hits::kMost) hits.list[hits.count++] = hit;
  return hits.opaque_count && !hits.model->transparent[hit.triangle];
}

// Whether a ray passes through a triangle by more than rounding could have made of it.
bool VisibilityRays::passes_inside(const OutsideRay& ray, const InstanceHit& hit) const {
  const auto& [u, v] = std::pair{hit.barycentric.x, hit.barycentric.y};
  constexpr double kInside = 1e-3;
  if (u > kInside && v > kInside && 1 - u - v > kInside) return true;
  const Vec3 at = ray.origin + hit.distance * ray.direction;
  const auto [a, b, c] = corners(hit.triangle);
  double sign = 0;
  for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
    const Vec3 edge = to - from;
    const double side = glm::dot(ray.direction, glm::cross(from - at, edge));
    if (!(std::fabs(side) > kRounding * radius_ * glm::length(edge))) return false;
    if (side * sign < 0) return false;
    sign = side;
  }
  return true;
}

// Whether rays beside this one reach the hit too: a ray that rounding let through a seam is alone.
bool VisibilityRays::is_open(const OutsideRay& ray, const InstanceHit& hit) const {
  const Vec3 front = normal(hit.triangle);
  const double slope = glm::dot(front, ray.direction);
  if (slope == 0) return false;
  const auto [right, up] = perpendiculars(ray.direction);
  int open = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 aside = kAside * radius_ * (kThirds[k].x * right + kThirds[k].y * up);
    const double end = hit.distance - glm::dot(front, aside) / slope;
    if (std::fabs(end - hit.distance) > radius_) continue;
    Hits hits;
    hits.model = &model_;
    hits.opaque_count = true;
    const geometry::Ray beside{ray.origin + aside, ray.direction, 0, end - kDepthSlack * radius_};
    open += !(has_transparent_ ? caster_.any(beside, {remember, &hits}) : caster_.any(beside));
  }
  return open >= 2;
}

void VisibilityRays::mark(const OutsideRay& ray, const InstanceHit& hit, std::uint32_t index,
                          std::vector<FirstHit>& found) {
  if (was_hit_before(hit) || !is_open(ray, hit)) return;
  first_round(hit).store(round_, std::memory_order_relaxed);
  found.push_back({hit.triangle, index});
}

// Marks what a ray hits first, and what lies in the same surface.
// thorough: the latter for every ray
void VisibilityRays::follow(const OutsideRay& ray, std::uint32_t index, bool thorough,
                            std::vector<FirstHit>& found) {
  Hits hits;
  hits.model = &model_;
  hits.opaque_count = true;
  geometry::Ray segment{ray.origin, ray.direction};
  const auto first =
      has_transparent_ ? caster_.closest(segment, {remember, &hits}) : caster_.closest(segment);
  const double end = first ? first->distance : HUGE_VAL;
  // transparent surfaces in front of it
  for (std::size_t i = 0; i < hits.count; ++i)
    if (model_.transparent[hits.list[i].triangle] &&
        hits.list[i].distance <= end + kDepthSlack * radius_ && passes_inside(ray, hits.list[i]))
      mark(ray, hits.list[i], index, found);
  // at an edge, a hit that rounding may have made proves nothing
  if (!first || !passes_inside(ray, *first)) return;
  mark(ray, *first, index, found);
  if (!thorough && index % kShare != 0) return;
  hits.count = 0;
  hits.opaque_count = false;
  segment.min_distance = end;
  segment.max_distance = end + kDepthSlack * radius_;
  (void)caster_.closest(segment, {remember, &hits});
  if (hits.count < 2) return;
  const Vec3 front = normal(first->triangle);
  for (std::size_t i = 0; i < hits.count; ++i) {
    const InstanceHit& hit = hits.list[i];
    if (hit.triangle != first->triangle && passes_inside(ray, hit) &&
        glm::length(glm::cross(front, normal(hit.triangle))) < kParallel)
      mark(ray, hit, index, found);
  }
}

// ---- many rays

std::vector<FirstHit> VisibilityRays::cast(std::uint64_t count, const MakeRay& make,
                                           bool thorough) {
  if (round_ < 0xffff) ++round_;
  const auto chunks = static_cast<std::size_t>((count + kChunk - 1) / kChunk);
  std::vector<std::vector<FirstHit>> parts(chunks);
  const auto cast_chunk = [&](std::size_t c) {
    const std::uint64_t end = std::min<std::uint64_t>(count, (c + 1) * kChunk);
    for (std::uint64_t i = c * kChunk; i < end; ++i)
      if (const std::optional<OutsideRay> ray = make(i))
        follow(*ray, static_cast<std::uint32_t>(i), thorough, parts[c]);
  };
  parallel_for(chunks, cast_chunk, job_);
  rays_ += count;
  std::vector<FirstHit> found;
  for (const auto& one : parts) found.insert(found.end(), one.begin(), one.end());
  std::sort(found.begin(), found.end());
  found.erase(
      std::unique(found.begin(), found.end(),
                  [](const FirstHit& a, const FirstHit& b) { return a.triangle == b.triangle; }),
      found.end());
  // a triangle whose other side was hit before is not new
  std::erase_if(found, [&](const FirstHit& one) {
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      const std::uint16_t round = hit_[2 * std::size_t{one.triangle} + side];
      if (round != 0 && round != round_) return true;
    }
    return false;
  });
  for (const FirstHit& one : found) ray_[one.triangle] = *make(one.ray);
  return found;
}

}  // namespace panwright::compiler::internal
