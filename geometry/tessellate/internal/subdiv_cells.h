// Four-sided cells of a cage, each of which becomes a grid of triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/tessellate/internal/subdiv_limit.h"

namespace panwright::geometry::internal {

// Cell: a four-sided face of a cage, or the quarter of another face, from a corner to the centre.
// Side i runs from corner i to the next, counter-clockwise.
struct Cell {
  std::uint32_t patch;     // of the limit surface
  Vec2 origin, along, up;  // of its parameters there
  std::uint32_t face;      // of the cage
  std::uint32_t corner;    // of that face, if it is a quarter
  std::uint32_t rail[4];   // of each side
  std::uint32_t place[4];  // of each corner
  Vec2 texcoord[4];        // of each corner
  bool quarter;
};

// Side of one cell or two. The first runs along it, the second against it.
struct Rail {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::uint32_t cell[2] = {kNone, kNone};
  std::uint32_t side[2] = {0, 0};
  bool splits = false;  // normals differ across it, or it is a border
  bool border() const { return cell[1] == kNone; }
};

struct Cells {
  std::vector<Cell> cells;
  std::vector<Rail> rails;
  std::uint32_t places = 0;  // corners of cells, each once
  bool textured = false;
};

// Expects: no problem. Cost: O(corners).
Cells cells_of(const Subdiv& shape, const Cage& cage);

// Returns the parameters of a point of a side, t = 0 to 1 along it.
Vec2 on_side(std::uint32_t side, double t);

// Limit surface over cells, with derivatives by their parameters.
class CellSurface {
 public:
  CellSurface(const LimitSurface& limit, const Cells& cells) : limit_(limit), cells_(cells) {}

  // Evaluates as LimitSurface::evaluate. Expects: 0 ≤ at ≤ 1.
  bool evaluate(const Cell& cell, const Vec2& at, LimitPoint& out) const;

  // Evaluates a corner with its normal, irregular ones too.
  CornerLimit corner(const Cell& cell, std::uint32_t which) const;

  const Cells& cells() const { return cells_; }

 private:
  const LimitSurface& limit_;
  const Cells& cells_;
};

// Returns the unit normal; 0 if derivatives give none.
Vec3 normal_of(const LimitPoint& point);

}  // namespace panwright::geometry::internal
