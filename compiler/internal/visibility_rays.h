// Rays from outside a model, and the sides of triangles that they hit first. Private to compiler.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "compiler/internal/visibility.h"
#include "geometry/ray/instances.h"

namespace panwright::compiler::internal {

// of the model's radius: surfaces closer than that fight for the same depth in a depth buffer
inline constexpr double kDepthSlack = 1e-5;

// A ray that begins outside the model.
struct OutsideRay {
  Vec3 origin;
  Vec3 direction;  // unit, inwards
};

// A triangle that a ray of this round was the first to hit.
struct FirstHit {
  std::uint32_t triangle;
  std::uint32_t ray;
  auto operator<=>(const FirstHit&) const = default;
};

// Numbers of the unique positions: for each position, equal ones alike, from 0; and their count.
std::pair<std::vector<std::uint32_t>, std::uint32_t> unique_positions(
    const std::vector<Vec3>& positions);

// Two unit vectors perpendicular to a unit vector and to each other.
std::array<Vec3, 2> perpendiculars(const Vec3& direction);

// Casts rays in rounds and remembers which side of which triangle was hit in which round.
class VisibilityRays {
 public:
  // The i-th ray of a round, where there is one. Called from any thread.
  using MakeRay = std::function<std::optional<OutsideRay>(std::uint64_t)>;

  VisibilityRays(WorldTriangles model, const Job& job);

  // Builds the search tree and the adjacency. False: nothing to see.
  bool prepare();

  // Casts `count` rays. Returns what they were the first to hit, each triangle once, in order of
  // triangles; ray_to() gives the ray of each.
  //   thorough  looks for surfaces at the same depth behind every ray, not every eighth
  std::vector<FirstHit> cast(std::uint64_t count, const MakeRay& make, bool thorough = true);

  std::uint64_t rays() const { return rays_; }
  std::uint32_t triangles() const { return static_cast<std::uint32_t>(model_.triangles.size()); }
  const Vec3& centre() const { return centre_; }
  double radius() const { return radius_; }
  bool has_transparent() const { return has_transparent_; }
  const geometry::InstanceCaster& caster() const { return caster_; }

  // Between rounds.
  bool is_visible(std::uint32_t triangle) const {
    return hit_[2 * std::size_t{triangle}] != 0 || hit_[2 * std::size_t{triangle} + 1] != 0;
  }
  bool is_undecided(std::uint32_t triangle) const {
    return model_.candidate[triangle] && !is_visible(triangle);
  }
  // Whether a round before this one hit that side.
  bool was_hit_before(const geometry::InstanceHit& hit);

  // The ray that hit a visible triangle first.
  const OutsideRay& ray_to(std::uint32_t triangle) const { return ray_[triangle]; }
  // A ray through a point, from outside.
  OutsideRay ray_through(const Vec3& point, const Vec3& inwards) const;

  std::array<Vec3, 3> corners(std::uint32_t triangle) const;
  Vec3 normal(std::uint32_t triangle) const;  // unit, or 0 without area
  double area(std::uint32_t triangle) const;
  // The number of pairs of corners at the same position.
  int common_corners(std::uint32_t a, std::uint32_t b) const;

  // Calls body(t) for triangles with a corner in common, some more than once.
  template <class Body>
  void for_neighbours(std::uint32_t triangle, const Body& body) const {
    constexpr std::uint32_t kMost = 64;  // at one position
    for (const std::uint32_t v : model_.triangles[triangle]) {
      const std::uint32_t begin = start_[position_[v]];
      const std::uint32_t end = std::min(start_[position_[v] + 1], begin + kMost);
      for (std::uint32_t i = begin; i < end; ++i)
        if (around_[i] != triangle) body(around_[i]);
    }
  }

 private:
  struct Hits;
  static bool remember(const void* data, const geometry::InstanceHit& hit);

  void list_neighbours();
  std::atomic<std::uint16_t>& first_round(const geometry::InstanceHit& hit);
  bool passes_inside(const OutsideRay& ray, const geometry::InstanceHit& hit) const;
  bool is_open(const OutsideRay& ray, const geometry::InstanceHit& hit) const;
  void mark(const OutsideRay& ray, const geometry::InstanceHit& hit, std::uint32_t index,
            std::vector<FirstHit>& found);
  void follow(const OutsideRay& ray, std::uint32_t index, bool thorough,
              std::vector<FirstHit>& found);

  WorldTriangles model_;
  const Job& job_;
  geometry::InstanceCaster caster_;
  Vec3 centre_{0};
  double radius_ = 0;
  bool has_transparent_ = false;
  std::vector<std::atomic<std::uint16_t>> hit_;  // 2*T: see first_round()
  std::vector<OutsideRay> ray_;                  // T: that hit it first
  std::vector<std::uint32_t> position_;          // V: unique
  std::vector<std::uint32_t> start_;             // of the rows of around_, by unique position
  std::vector<std::uint32_t> around_;
  std::uint16_t round_ = 0;
  std::uint64_t rays_ = 0;
};

}  // namespace panwright::compiler::internal
