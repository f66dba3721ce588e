// The triangles of a group, cut finer.
#pragma once

#include <array>
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

// Of each point: 0 at the border to 1 from `reach` on. longest: of the border's edges.
std::vector<double> tapers(const Piece& piece, const Edges& border, double reach, double longest,
                           const Job& job);

}  // namespace panwright::mli
