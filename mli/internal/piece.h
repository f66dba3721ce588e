// Triangles of a group, subdivided.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "base/job.h"
#include "mli/internal/groups.h"

namespace panwright::mli {

struct Piece {
  std::vector<Vec3> points;
  std::vector<geometry::Triangle> triangles;
};

using Edges = std::vector<std::array<std::uint32_t, 2>>;

Piece piece_of(const Faces& faces, const Group& group);

// Halves every edge above `longest`, in rounds; false: more triangles than the limit.
bool refine(Piece& piece, double longest, double limit, const Job& job);

// Returns the edges of one triangle each, in its direction, in order of triangles.
Edges border_of(const Piece& piece);

// Distances of places from a border.
class BorderDistance {
 public:
  // reach: metres; larger distances are clamped to it. longest: of the border's edges.
  BorderDistance(const Piece& piece, const Edges& border, double reach, double longest);
  double at(const Vec3& place) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell(const Vec3& place) const;

  double reach_, size_;
  std::map<Cell, std::vector<std::array<Vec3, 2>>> cells_;  // edges, by their middles
};

// New point on an edge: low + part · (high − low).
struct Cut {
  std::uint32_t low, high;
  double part;
};

// Cuts triangles along the line at distance `width`, moving points next to it onto it. distances:
// extended by the new points. Returns for each triangle true if it lies within. cuts: the new
// points, in order, on request.
std::vector<char> cut_at(Piece& piece, std::vector<double>& distances, double width,
                         std::vector<Cut>* cuts = nullptr);

}  // namespace panwright::mli
