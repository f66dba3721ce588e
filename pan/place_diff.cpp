#include "pan/place_diff.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <unordered_map>

#include "base/axis_box.h"
#include "base/hash.h"
#include "pan/fields.h"

namespace panwright::pan {

namespace {

struct PlacedTriangle {
  std::array<Vec3, 3> corners;
  std::uint32_t instance = 0;
  bool matched = false;
  Vec3 centre() const { return (corners[0] + corners[1] + corners[2]) / 3.0; }
};

std::vector<PlacedTriangle> placed_triangles(const Model& model, AxisBox& bounds) {
  std::vector<PlacedTriangle> out;
  const std::vector<Mat4> world = model.world_from_nodes();
  for (std::uint32_t i = 0; i < model.instances().size(); ++i) {
    const layout::Instance& instance = model.instances()[i];
    const MeshView mesh = model.mesh(instance.mesh);
    const double* o = model.meshes()[instance.mesh].origin;
    const Vec3 origin(o[0], o[1], o[2]);
    const Mat4& m = world[instance.node];
    const bool mirrored = glm::determinant(Mat3(m)) < 0;
    std::vector<Vec3> positions;
    positions.reserve(mesh.positions.size());
    for (const layout::Float3& p : mesh.positions) {
      positions.emplace_back(m * Vec4(origin + Vec3(p.x, p.y, p.z), 1));
      bounds.add(positions.back());
    }
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
      PlacedTriangle t;
      for (std::size_t c = 0; c < 3; ++c) t.corners[c] = positions[mesh.indices[k + c]];
      if (mirrored) std::swap(t.corners[1], t.corners[2]);
      t.instance = i;
      out.push_back(t);
    }
  }
  return out;
}

// Largest distance of corners, for the best of the three rotations.
double distance(const PlacedTriangle& a, const PlacedTriangle& b) {
  double best = HUGE_VAL;
  for (std::size_t turn = 0; turn < 3; ++turn) {
    double worst = 0;
    for (std::size_t c = 0; c < 3; ++c)
      worst = std::max(worst, glm::length(a.corners[c] - b.corners[(c + turn) % 3]));
    best = std::min(best, worst);
  }
  return best;
}

// Cells of space, by the centres of triangles.
class Grid {
 public:
  Grid(const std::vector<PlacedTriangle>& triangles, const Vec3& low, double cell)
      : low_(low), cell_(cell) {
    next_.assign(triangles.size(), kEnd);
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      const auto [first, is_new] = first_.try_emplace(key_of(place_of(triangles[i].centre())), i);
      if (is_new) continue;
      next_[i] = first->second;
      first->second = i;
    }
  }

  // Calls visit(i) for the triangles near a point.
  template <class Visit>
  void near(const Vec3& point, const Visit& visit) const {
    const std::array<double, 3> at = place_of(point);
    for (int k = 0; k < 27; ++k) {
      const auto found = first_.find(key_of(
          {at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + static_cast<double>(k / 9) - 1}));
      if (found == first_.end()) continue;
      for (std::uint32_t i = found->second; i != kEnd; i = next_[i]) visit(i);
    }
  }

 private:
  static constexpr std::uint32_t kEnd = 0xffffffffu;

  std::array<double, 3> place_of(const Vec3& p) const {
    const Vec3 cell = glm::floor((p - low_) / cell_);
    return {cell.x + 0.0, cell.y + 0.0, cell.z + 0.0};
  }
  static std::uint64_t key_of(const std::array<double, 3>& place) {
    return hash64(std::as_bytes(std::span(place)));
  }

  Vec3 low_;
  double cell_;
  std::unordered_map<std::uint64_t, std::uint32_t> first_;
  std::vector<std::uint32_t> next_;
};

void add_unmatched(const Model& model, const std::vector<PlacedTriangle>& triangles, bool in_a,
                   std::vector<UnmatchedPart>& out) {
  std::vector<std::uint64_t> unmatched(model.instances().size());
  for (const PlacedTriangle& t : triangles) unmatched[t.instance] += !t.matched;
  for (std::size_t i = 0; i < unmatched.size(); ++i)
    if (unmatched[i] > 0)
      out.push_back(
          {record_words(model, layout::SectionKind::instances, static_cast<std::int64_t>(i)), in_a,
           unmatched[i], model.meshes()[model.instances()[i].mesh].triangle_count});
}

}  // namespace

PlaceDifferences diff_by_place(const Model& a, const Model& b, double tolerance) {
  PlaceDifferences out;
  AxisBox bounds;
  std::vector<PlacedTriangle> in_a = placed_triangles(a, bounds),
                              in_b = placed_triangles(b, bounds);
  out.triangles_a = in_a.size();
  out.triangles_b = in_b.size();
  constexpr double kRelative = 1e-6;
  const double diagonal = bounds.empty() ? 0 : glm::length(bounds.extent());
  out.tolerance = tolerance > 0 ? tolerance : std::max(kRelative * diagonal, 1e-30);
  // centres are as near as corners; cells hold both sides of their borders
  const Grid grid(in_b, bounds.empty() ? Vec3(0) : bounds.low, 2 * out.tolerance);
  for (PlacedTriangle& t : in_a) {
    double best = HUGE_VAL;
    std::uint32_t found = 0;
    grid.near(t.centre(), [&](std::uint32_t i) {
      if (in_b[i].matched) return;
      if (const double d = distance(t, in_b[i]); d < best) best = d, found = i;
    });
    if (!(best <= out.tolerance)) continue;
    t.matched = in_b[found].matched = true;
    out.largest = std::max(out.largest, best);
  }
  add_unmatched(a, in_a, true, out.parts);
  add_unmatched(b, in_b, false, out.parts);
  return out;
}

}  // namespace panwright::pan
