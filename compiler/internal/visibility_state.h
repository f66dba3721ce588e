// Visibility of a model's triangles, and rounds of rays that determine it. Private to compiler.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/parallel.h"
#include "compiler/internal/visibility_rays.h"

namespace panwright::compiler::internal {

// Visibility of a triangle of a mesh, or of a part.
enum class State : char { unknown, seen, kept, hidden_alone };

// A ray that escapes.
struct Find {
  std::uint32_t triangle;
  std::uint32_t side;
  Vec3 point;
  Vec3 direction;
};

// Results of a chunk of triangles.
struct Harvest {
  std::uint64_t rays = 0;
  std::vector<Find> finds;
  std::vector<std::size_t> exposed;  // sides
};

// Visibility of triangles for their meshes and parts: w is a number of VisibilityRays.
class VisibilityState {
 public:
  VisibilityState(const VisibilityModel& model, const VisibilityOptions& options, const Job& job);

  Visibility result() const;

 protected:
  enum class Which { all, enclosed, exposed };
  static constexpr std::size_t kChunk = 128;  // items taken by a thread at once

  // Returns the index in its mesh.
  std::uint32_t index_of(std::uint32_t w) const {
    const std::uint32_t p = rays_.part_of(w);
    return mesh_first_[model_.parts[p].mesh] + (w - rays_.first_of(p));
  }
  bool is_seen(std::uint32_t w) const {
    return side_seen_[2 * std::size_t{w}] || side_seen_[2 * std::size_t{w} + 1];
  }
  // Returns true if the result matters: not if the triangle is visible elsewhere and its part
  // visible.
  bool is_undecided(std::uint32_t w) const {
    const State triangle = triangles_[index_of(w)];
    return triangle == State::unknown ||
           (triangle != State::hidden_alone && parts_[rays_.part_of(w)] == State::unknown);
  }
  void keep(std::uint32_t w);
  // Returns the undecided triangles in order. Those that face a visible side are kept if too many
  // to decide.
  std::vector<std::uint32_t> undecided(Which which);
  std::uint64_t rays_left() const { return max_rays_ - std::min(max_rays_, cast_); }
  // Truncates the items to the rays left; the others stay.
  void fit(std::vector<std::uint32_t>& items, std::uint64_t each);

  // Calls body(i, harvest) for i in [0, count) and records the results. Data read by bodies does
  // not change meanwhile. Returns the finds of newly visible triangles.
  template <class Body>
  std::vector<Find> round(std::size_t count, const Body& body) {
    std::vector<Harvest> parts((count + kChunk - 1) / kChunk);
    parallel_for(
        parts.size(),
        [&](std::size_t c) {
          const std::size_t end = std::min(count, (c + 1) * kChunk);
          for (std::size_t i = c * kChunk; i < end; ++i) body(i, parts[c]);
        },
        job_);
    std::vector<Find> fresh;
    for (const Harvest& one : parts) {
      cast_ += one.rays;
      for (const std::size_t side : one.exposed) side_exposed_[side] = 1;
      for (const Find& find : one.finds)
        if (mark(find)) fresh.push_back(find);
    }
    return fresh;
  }

  const VisibilityModel& model_;
  const VisibilityOptions& options_;
  const Job& job_;
  VisibilityRays rays_;
  std::vector<std::uint32_t> mesh_first_;             // M + 1: of each mesh, its first triangle
  std::vector<std::vector<std::uint32_t>> parts_of_;  // M
  std::vector<State> triangles_;                      // of meshes
  std::vector<Vec3> directions_;                      // of meshes: of a ray that escaped
  std::vector<State> parts_;                          // P
  std::vector<char> exposed_;                         // of the world: faces a visible side
  std::vector<char> near_exposed_;  // of the world: rays hit such a triangle, to a few
  std::vector<char> side_seen_;     // two for each of the world
  std::vector<char> side_exposed_;  // the same: faces a visible side
  bool keep_exposed_ = false;
  bool capped_ = false;
  std::uint64_t max_rays_ = 0;
  std::uint64_t cast_ = 0;  // rays
  std::uint64_t last_found_ = 0;
  std::uint64_t ambiguous_ = 0;
  std::uint32_t done_ = 0;  // rays of each triangle that is undecided

 private:
  // Returns true if the triangle was not visible before.
  bool mark(const Find& find);
};

}  // namespace panwright::compiler::internal
