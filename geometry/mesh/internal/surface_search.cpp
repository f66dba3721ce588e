#include "geometry/mesh/internal/surface_search.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace panwright::geometry {
namespace {

constexpr std::size_t kSearchChunk = 512;

// The squared distance of (s, t) from the segment between the origin and (u, h).
double squared_from_side(double s, double t, double u, double h) {
  const double squared = u * u + h * h;
  const double share = squared > 0 ? std::clamp((s * u + t * h) / squared, 0.0, 1.0) : 0;
  const double x = s - share * u;
  const double y = t - share * h;
  return x * x + y * y;
}

}  // namespace

FramedTriangle::FramedTriangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  Vec3 corner[3] = {a, b, c};
  double longest = -1;
  int first = 0;
  for (int k = 0; k < 3; ++k) {
    const double length = glm::length(corner[(k + 1) % 3] - corner[k]);
    if (length > longest) first = k;
    longest = std::max(longest, length);
  }
  origin_ = corner[first];
  length_ = longest;
  if (!(longest > 0)) return;
  along_ = (corner[(first + 1) % 3] - origin_) / longest;
  const Vec3 third = corner[(first + 2) % 3] - origin_;
  u_ = std::clamp(glm::dot(third, along_), 0.0, longest);
  Vec3 across = third - glm::dot(third, along_) * along_;
  h_ = glm::length(across);
  if (h_ > 0) {
    // what rounding left of the edge's direction, which counts in needles
    across /= h_;
    across -= glm::dot(across, along_) * along_;
  } else {
    across = glm::cross(along_, std::fabs(along_.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0));
  }
  across_ = glm::normalize(across);
  normal_ = glm::cross(along_, across_);
}

double FramedTriangle::squared_distance(const Vec3& point) const {
  const Vec3 off = point - origin_;
  if (!(length_ > 0)) return glm::dot(off, off);
  const double s = glm::dot(off, along_);
  const double t = glm::dot(off, across_);
  const double n = glm::dot(off, normal_);
  if (t <= 0) {  // angles at the longest edge are sharp
    const double x = s - std::clamp(s, 0.0, length_);
    return x * x + t * t + n * n;
  }
  double planar = HUGE_VAL;
  if (h_ * s < u_ * t) planar = squared_from_side(s, t, u_, h_);
  if (h_ * (length_ - s) < (length_ - u_) * t)
    planar = std::min(planar, squared_from_side(length_ - s, t, length_ - u_, h_));
  return (planar < HUGE_VAL ? planar : 0) + n * n;
}

SurfaceSearch::SurfaceSearch(const Mesh& mesh) : mesh_(&mesh) {
  std::vector<AxisBox> boxes(mesh.triangles.size());
  triangles_.reserve(mesh.triangles.size());
  AxisBox all;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    for (const std::uint32_t corner : t) boxes[i].add(mesh.positions[corner]);
    triangles_.emplace_back(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
    all.add(boxes[i]);
  }
  if (!all.empty()) {
    diagonal_ = glm::length(all.high - all.low);
    for (int k = 0; k < 3; ++k)
      largest_ = std::max({largest_, std::fabs(all.low[k]), std::fabs(all.high[k])});
  }
  tree_.build(std::move(boxes));
}

SurfaceSearch::Nearest SurfaceSearch::nearest(const Vec3& point, std::uint32_t hint) const {
  Nearest best;
  if (hint < triangles_.size()) best = {hint, triangles_[hint].squared_distance(point)};
  tree_.near(point, best.squared, [&](std::uint32_t index) {
    const double squared = triangles_[index].squared_distance(point);
    if (squared < best.squared || (squared == best.squared && index < best.triangle))
      best = {index, squared};
  });
  return best;
}

SurfaceSearch::Nearest SurfaceSearch::nearest_facing(const Vec3& point, const Vec3& direction,
                                                     double reach, std::uint32_t hint) const {
  Nearest best;
  double limit = reach * reach;
  tree_.near(point, limit, [&](std::uint32_t index) {
    const Triangle& t = mesh_->triangles[index];
    const Vec3& corner = mesh_->positions[t[0]];
    const Vec3 facet = glm::cross(mesh_->positions[t[1]] - corner, mesh_->positions[t[2]] - corner);
    if (!(glm::dot(facet, direction) > 0)) return;
    const double squared = triangles_[index].squared_distance(point);
    if (squared < best.squared || (squared == best.squared && index < best.triangle))
      best = {index, squared};
    limit = std::min(limit, squared);
  });
  return best.squared <= reach * reach ? best : nearest(point, hint);
}

std::vector<SurfaceSearch::Nearest> SurfaceSearch::nearest_of_vertices(const Mesh& other,
                                                                       const Job& job) const {
  std::vector<Nearest> found(other.positions.size());
  std::vector<char> used(other.positions.size());
  for (const Triangle& t : other.triangles)
    for (const std::uint32_t corner : t) used[corner] = 1;
  parallel_for((found.size() + kSearchChunk - 1) / kSearchChunk,
               [&](std::size_t chunk) {
                 std::uint32_t hint = 0;
                 const std::size_t end = std::min(found.size(), (chunk + 1) * kSearchChunk);
                 for (std::size_t i = chunk * kSearchChunk; i < end; ++i) {
                   if (!used[i]) continue;
                   found[i] = nearest(other.positions[i], hint);
                   hint = found[i].triangle;
                 }
               },
               job);
  return found;
}

}  // namespace panwright::geometry
