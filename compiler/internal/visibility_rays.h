// Rays from the triangles of a model to the outside. Private to compiler.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "compiler/internal/visibility.h"
#include "geometry/ray/instances.h"

namespace panwright::compiler::internal {

// of the model's radius: closer surfaces share a depth in a depth buffer
inline constexpr double kDepthSlack = 1e-5;

// Numbers of the unique positions: for each position, equal ones alike, from 0; and their count.
std::pair<std::vector<std::uint32_t>, std::uint32_t> unique_positions(
    const std::vector<Vec3>& positions);

// Two unit vectors perpendicular to a unit vector and to each other.
std::array<Vec3, 2> perpendiculars(const Vec3& direction);

// First hit of a ray.
struct Meeting {
  std::uint32_t triangle = 0;
  std::uint32_t side = 0;  // 0: the front, to which its corners turn counter-clockwise
  Vec3 point{0};
};

// A model in the world: its triangles are numbered part by part.
class VisibilityRays {
 public:
  VisibilityRays(const VisibilityModel& model, const VisibilityOptions& options, const Job& job);

  // Builds the search tree. False: no triangles.
  bool prepare();

  std::uint32_t triangles() const { return first_.back(); }
  std::uint32_t first_of(std::size_t part) const { return first_[part]; }
  std::uint32_t part_of(std::uint32_t triangle) const { return part_of_[triangle]; }
  const Vec3& centre() const { return centre_; }
  double radius() const { return radius_; }
  double slack() const { return slack_; }

  std::array<Vec3, 3> corners(std::uint32_t triangle) const;
  Vec3 normal(std::uint32_t triangle) const;  // unit, or 0 without area
  double area(std::uint32_t triangle) const;

  // Returns true if a ray from a point of a triangle leads outside. Ignores the triangle itself,
  // transparent parts, and surfaces within slack() of the same one.
  bool escapes(std::uint32_t triangle, const Vec3& point, const Vec3& direction) const;
  std::optional<Meeting> meets(std::uint32_t triangle, const Vec3& point,
                               const Vec3& direction) const;
  // Returns true if rays beside an escaping one escape too; a lone one slipped through a seam by
  // rounding.
  bool is_open(std::uint32_t triangle, const Vec3& point, const Vec3& direction) const;
  // Returns the first hit of a ray from outside, ignoring transparent surfaces.
  std::optional<Meeting> first_from_outside(const Vec3& point, const Vec3& inwards) const;

  // ---- neighbours

  // Lists neighbours in the marked parts.
  void list_neighbours(const std::vector<char>& parts);
  // Calls body(t) for triangles with a corner in common, some more than once. None in other parts
  // than those listed.
  template <class Body>
  void for_neighbours(std::uint32_t triangle, const Body& body) const {
    constexpr std::uint32_t kMost = 64;  // at one position
    if (vertex_base_.empty() || vertex_base_[part_of_[triangle]] == kNone) return;
    for (const std::uint32_t position : positions_of(triangle)) {
      const std::uint32_t begin = start_[position];
      const std::uint32_t end = std::min(start_[position + 1], begin + kMost);
      for (std::uint32_t i = begin; i < end; ++i)
        if (around_[i] != triangle) body(around_[i]);
    }
  }
  // The number of pairs of corners at the same position. Expects: both in listed parts.
  int common_corners(std::uint32_t a, std::uint32_t b) const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  struct Start;
  static bool counts(const void* data, const geometry::InstanceHit& hit);

  const geometry::Mesh& mesh_of(std::uint32_t part) const {
    return *model_.meshes[model_.parts[part].mesh];
  }
  void place_parts();
  std::uint32_t triangle_of(const geometry::InstanceHit& hit) const;
  Meeting meeting_at(const geometry::InstanceHit& hit, const Vec3& point,
                     const Vec3& direction) const;
  std::array<std::uint32_t, 3> positions_of(std::uint32_t triangle) const;

  const VisibilityModel& model_;
  const VisibilityOptions& options_;
  const Job& job_;
  geometry::InstanceCaster caster_;
  std::vector<std::uint32_t> first_;        // P + 1: of each part, its first triangle
  std::vector<std::uint32_t> part_of_;      // of each triangle
  std::vector<std::uint32_t> caster_part_;  // of each of the caster's instances
  std::vector<char> mirrored_;              // the same: its fronts are backs in the world
  std::vector<std::uint32_t> flat_;         // triangles of the caster's first mesh
  Vec3 centre_{0};
  double radius_ = 0;
  double slack_ = 0;
  std::vector<std::uint32_t> vertex_base_;  // P: in position_; kNone: not listed
  std::vector<std::uint32_t> position_;     // of each listed vertex: unique
  std::vector<std::uint32_t> start_;        // of the rows of around_, by unique position
  std::vector<std::uint32_t> around_;
};

}  // namespace panwright::compiler::internal
