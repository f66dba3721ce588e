#include "compiler/internal/visibility_rays.h"

#include <bit>
#include <cmath>
#include <tuple>

#include "base/axis_box.h"

namespace panwright::compiler::internal {

namespace {

using geometry::InstanceHit;

// sine of the angle between surfaces that are one
constexpr double kParallel = 1e-3;
// of the radius: farther than what a search in single precision may be wrong by (2e-6)
constexpr double kAside = 3e-6;
// unit vectors a third of a turn apart
const Vec2 kThirds[] = {
    {0.8, 0.6}, {-0.9196152422706632, 0.39282032302755}, {0.1196152422706632, -0.99282032302755}};
// triangles that are searched in one tree: two levels cost more time, and one more memory
constexpr std::uint64_t kOneTree = 2'000'000;

}  // namespace

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

VisibilityRays::VisibilityRays(const VisibilityModel& model, const VisibilityOptions& options,
                               const Job& job)
    : model_(model), options_(options), job_(job) {
  first_.push_back(0);
  for (std::uint32_t p = 0; p < model_.parts.size(); ++p) {
    const auto count = static_cast<std::uint32_t>(mesh_of(p).triangles.size());
    part_of_.resize(part_of_.size() + count, p);
    first_.push_back(first_.back() + count);
  }
}

bool VisibilityRays::prepare() {
  AxisBox box;
  for (std::uint32_t p = 0; p < model_.parts.size(); ++p) {
    const geometry::Mesh& mesh = mesh_of(p);
    for (const geometry::Triangle& t : mesh.triangles)
      for (const std::uint32_t v : t)
        box.add(Vec3(model_.parts[p].world_from_mesh * Vec4(mesh.positions[v], 1)));
    job_.poll();
  }
  if (triangles() == 0) return false;
  centre_ = box.centre();
  radius_ = 0.5 * box.diagonal();
  slack_ = std::max(kDepthSlack * radius_, options_.least_slack);
  if (!(radius_ > 0)) return false;
  place_parts();
  caster_.build(job_);
  return true;
}

// Parts go into one tree, in world coordinates; where that would be large, meshes with several
// parts have one of their own.
void VisibilityRays::place_parts() {
  std::vector<std::uint32_t> uses(model_.meshes.size(), 0);
  for (const VisibilityPart& part : model_.parts) ++uses[part.mesh];
  const bool one = triangles() <= kOneTree;
  const auto is_flat = [&](std::uint32_t p) { return one || uses[model_.parts[p].mesh] == 1; };
  std::vector<Vec3> positions;
  std::vector<geometry::Triangle> list;
  for (std::uint32_t p = 0; p < model_.parts.size(); ++p) {
    if (!is_flat(p)) continue;
    const geometry::Mesh& mesh = mesh_of(p);
    const auto base = static_cast<std::uint32_t>(positions.size());
    for (const Vec3& at : mesh.positions)
      positions.push_back(Vec3(model_.parts[p].world_from_mesh * Vec4(at, 1)));
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const geometry::Triangle& from = mesh.triangles[t];
      list.push_back({base + from[0], base + from[1], base + from[2]});
      if (!one) flat_.push_back(first_[p] + t);
    }
  }
  const auto place = [&](std::uint32_t mesh, std::uint32_t part, const Mat4& world_from_mesh) {
    caster_.add(mesh, world_from_mesh, true);
    caster_part_.push_back(part);
    mirrored_.push_back(glm::determinant(Mat3(world_from_mesh)) < 0);
  };
  place(caster_.add_mesh(geometry::search_mesh(std::move(positions), std::move(list), job_)), kNone,
        Mat4(1));
  if (one) return;
  std::vector<std::uint32_t> known(model_.meshes.size(), kNone);
  for (std::uint32_t p = 0; p < model_.parts.size(); ++p) {
    if (is_flat(p)) continue;
    std::uint32_t& mesh = known[model_.parts[p].mesh];
    if (mesh == kNone) mesh = caster_.add_mesh(mesh_of(p).positions, mesh_of(p).triangles);
    place(mesh, p, model_.parts[p].world_from_mesh);
  }
}

// ---- triangles

std::array<Vec3, 3> VisibilityRays::corners(std::uint32_t triangle) const {
  const std::uint32_t p = part_of_[triangle];
  const geometry::Mesh& mesh = mesh_of(p);
  const geometry::Triangle& t = mesh.triangles[triangle - first_[p]];
  const Mat4& place = model_.parts[p].world_from_mesh;
  return {Vec3(place * Vec4(mesh.positions[t[0]], 1)), Vec3(place * Vec4(mesh.positions[t[1]], 1)),
          Vec3(place * Vec4(mesh.positions[t[2]], 1))};
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

std::uint32_t VisibilityRays::triangle_of(const InstanceHit& hit) const {
  const std::uint32_t part = caster_part_[hit.instance];
  if (part != kNone) return first_[part] + hit.triangle;
  return flat_.empty() ? hit.triangle : flat_[hit.triangle];
}

// ---- one ray

// Where a ray starts; kNone: outside.
struct VisibilityRays::Start {
  const VisibilityRays* rays;
  std::uint32_t triangle;
};

// A filter of hits.
bool VisibilityRays::counts(const void* data, const InstanceHit& hit) {
  const Start& start = *static_cast<const Start*>(data);
  const VisibilityRays& rays = *start.rays;
  const std::uint32_t triangle = rays.triangle_of(hit);
  if (triangle == start.triangle) return false;
  if (rays.model_.parts[rays.part_of_[triangle]].transparent) return false;
  if (start.triangle == kNone || hit.distance > rays.slack_) return true;
  const Vec3 apart = glm::cross(rays.normal(start.triangle), rays.normal(triangle));
  return !(glm::length(apart) < kParallel);
}

bool VisibilityRays::escapes(std::uint32_t triangle, const Vec3& point,
                             const Vec3& direction) const {
  const Start start{this, triangle};
  return !caster_.any({point, direction}, {counts, &start});
}

Meeting VisibilityRays::meeting_at(const InstanceHit& hit, const Vec3& point,
                                   const Vec3& direction) const {
  const bool front = hit.front != (mirrored_[hit.instance] != 0);
  return {triangle_of(hit), front ? 0u : 1u, point + hit.distance * direction};
}

std::optional<Meeting> VisibilityRays::meets(std::uint32_t triangle, const Vec3& point,
                                             const Vec3& direction) const {
  const Start start{this, triangle};
  const auto hit = caster_.closest({point, direction}, {counts, &start});
  if (!hit) return std::nullopt;
  return meeting_at(*hit, point, direction);
}

bool VisibilityRays::is_open(std::uint32_t triangle, const Vec3& point,
                             const Vec3& direction) const {
  const Vec3 front = normal(triangle);
  const Vec3 outwards = glm::dot(front, direction) < 0 ? -front : front;
  const auto [right, up] = perpendiculars(direction);
  int open = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 aside = kAside * radius_ * (kThirds[k].x * right + kThirds[k].y * up);
    // never behind the surface
    const double height = glm::dot(outwards, aside);
    const Vec3 beside = point + aside + (std::fabs(height) - height) * outwards;
    open += escapes(triangle, beside, direction);
    if (open == 2) return true;
    if (open + 2 - k < 2) return false;
  }
  return false;
}

std::optional<Meeting> VisibilityRays::first_from_outside(const Vec3& point,
                                                          const Vec3& inwards) const {
  const Vec3 origin = point - (glm::dot(point - centre_, inwards) + 2 * radius_) * inwards;
  return meets(kNone, origin, inwards);
}

// ---- neighbours

std::array<std::uint32_t, 3> VisibilityRays::positions_of(std::uint32_t triangle) const {
  const std::uint32_t p = part_of_[triangle];
  const geometry::Triangle& t = mesh_of(p).triangles[triangle - first_[p]];
  const std::uint32_t base = vertex_base_[p];
  return {position_[base + t[0]], position_[base + t[1]], position_[base + t[2]]};
}

// Triangles by the unique positions of their corners, as compressed rows.
void VisibilityRays::list_neighbours(const std::vector<char>& parts) {
  vertex_base_.assign(model_.parts.size(), kNone);
  std::vector<Vec3> positions;
  for (std::uint32_t p = 0; p < model_.parts.size(); ++p) {
    if (!parts[p]) continue;
    vertex_base_[p] = static_cast<std::uint32_t>(positions.size());
    for (const Vec3& at : mesh_of(p).positions)
      positions.push_back(Vec3(model_.parts[p].world_from_mesh * Vec4(at, 1)));
  }
  job_.poll();
  std::uint32_t unique = 0;
  std::tie(position_, unique) = unique_positions(positions);
  start_.assign(std::size_t{unique} + 2, 0);
  const auto for_corners = [&](const auto& body) {
    for (std::uint32_t p = 0; p < model_.parts.size(); ++p)
      for (std::uint32_t t = first_[p]; parts[p] && t < first_[p + 1]; ++t)
        for (const std::uint32_t at : positions_of(t)) body(t, at);
  };
  for_corners([&](std::uint32_t, std::uint32_t at) { ++start_[at + 2]; });
  for (std::size_t i = 2; i < start_.size(); ++i) start_[i] += start_[i - 1];
  around_.resize(start_.back());
  for_corners([&](std::uint32_t t, std::uint32_t at) { around_[start_[at + 1]++] = t; });
}

int VisibilityRays::common_corners(std::uint32_t a, std::uint32_t b) const {
  int common = 0;
  for (const std::uint32_t i : positions_of(a))
    for (const std::uint32_t j : positions_of(b)) common += i == j;
  return common;
}

}  // namespace panwright::compiler::internal
