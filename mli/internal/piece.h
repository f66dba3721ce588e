// The triangles of a group, cut finer.
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

// The edges of one triangle each, as it goes around, in order of triangles.
Edges border_of(const Piece& piece);

// How far places are from a border.
class BorderDistance {
 public:
  // reach: metres; what is farther is as far. longest: of the border's edges.
  BorderDistance(const Piece& piece, const Edges& border, double reach, double longest);
  double at(const Vec3& place) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell(const Vec3& place) const;

  double reach_, size_;
  std::map<Cell, std::vector<std::array<Vec3, 2>>> cells_;  // edges, by their middles
};

// A new point on an edge: low + part · (high − low).
struct Cut {
  std::uint32_t low, high;
  double part;
};

// Cuts triangles along the line where the points' distances are `width`, and moves it to points
// that are next to it. distances: of new points too, then. Returns for each triangle whether it
// lies within. cuts: what the new points are, in order, where somebody asks.
std::vector<char> cut_at(Piece& piece, std::vector<double>& distances, double width,
                         std::vector<Cut>* cuts = nullptr);

}  // namespace panwright::mli
