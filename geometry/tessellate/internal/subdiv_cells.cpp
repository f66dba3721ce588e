#include "geometry/tessellate/internal/subdiv_cells.h"

#include <algorithm>

namespace panwright::geometry::internal {

namespace {

constexpr Vec2 kCorners[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

void join(Rail& rail, std::uint32_t which, std::uint32_t cell, std::uint32_t side, Cells& out) {
  rail.cell[which] = cell;
  rail.side[which] = side;
  out.cells[cell].rail[side] = static_cast<std::uint32_t>(&rail - out.rails.data());
}

Vec2 texcoord(const Subdiv& shape, std::size_t face, std::size_t corner) {
  const auto& list = shape.faces[face].texcoords;
  return list.empty() ? Vec2(0) : shape.texcoords[list[corner]];
}

// Cells are faces, rails edges, places vertices.
Cells whole_faces(const Subdiv& shape, const Cage& cage) {
  Cells out;
  out.cells.resize(cage.faces());
  for (std::uint32_t f = 0; f < cage.faces(); ++f) {
    Cell& cell = out.cells[f];
    cell = {f, Vec2(0), Vec2(1, 0), Vec2(0, 1), f, 0, {}, {}, {}, false};
    for (std::uint32_t k = 0; k < 4; ++k) {
      cell.place[k] = cage.vertex[cage.first[f] + k];
      cell.texcoord[k] = texcoord(shape, f, k);
    }
  }
  out.places = static_cast<std::uint32_t>(shape.positions.size());
  out.rails.resize(cage.edges.size());
  for (std::size_t e = 0; e < cage.edges.size(); ++e) {
    out.rails[e].splits = cage.edges[e].splits();
    for (std::uint32_t which = 0; which < 2; ++which)
      if (const std::uint32_t c = cage.edges[e].corner[which]; c != kNoCorner)
        join(out.rails[e], which, c / 4, c % 4, out);
  }
  return out;
}

Cell quarter_of(const Subdiv& shape, const Cage& cage, std::uint32_t f, std::uint32_t i,
                std::uint32_t patch) {
  const std::uint32_t n = cage.sides(f);
  const auto vertices = static_cast<std::uint32_t>(shape.positions.size());
  const std::uint32_t corner = cage.first[f] + i;
  const std::uint32_t before = (i + n - 1) % n;
  Cell cell{patch, Vec2(0), Vec2(1, 0), Vec2(0, 1), f, i, {}, {}, {}, true};
  if (n == 4) {
    cell.origin = kCorners[i];
    cell.along = 0.5 * (kCorners[(i + 1) % 4] - kCorners[i]);
    cell.up = 0.5 * (kCorners[before] - kCorners[i]);
  } else {
    cell.patch += i;
  }
  cell.place[0] = cage.vertex[corner];
  cell.place[1] = vertices + cage.edge[corner];
  cell.place[2] = vertices + static_cast<std::uint32_t>(cage.edges.size()) + f;
  cell.place[3] = vertices + cage.edge[cage.first[f] + before];
  const Vec2 here = texcoord(shape, f, i);
  cell.texcoord[0] = here;
  cell.texcoord[1] = 0.5 * (here + texcoord(shape, f, (i + 1) % n));
  for (std::uint32_t k = 0; k < n; ++k) cell.texcoord[2] += texcoord(shape, f, k);
  cell.texcoord[2] /= static_cast<double>(n);
  cell.texcoord[3] = 0.5 * (here + texcoord(shape, f, before));
  return cell;
}

// Cells are quarters, one for each corner of the cage; rails halves of edges, then from the middle
// of each side to the centre.
Cells quarters(const Subdiv& shape, const Cage& cage) {
  Cells out;
  std::uint32_t patch = 0;
  std::vector<std::uint32_t> next(cage.vertex.size());
  for (std::uint32_t f = 0; f < cage.faces(); ++f) {
    const std::uint32_t n = cage.sides(f);
    for (std::uint32_t i = 0; i < n; ++i) {
      out.cells.push_back(quarter_of(shape, cage, f, i, patch));
      next[cage.first[f] + i] = cage.first[f] + (i + 1) % n;
    }
    patch += n == 4 ? 1 : n;
  }
  out.places =
      static_cast<std::uint32_t>(shape.positions.size() + cage.edges.size() + cage.faces());
  out.rails.resize(2 * cage.edges.size() + cage.vertex.size());
  for (std::size_t e = 0; e < cage.edges.size(); ++e) {
    const Cage::Edge& edge = cage.edges[e];
    Rail& begin = out.rails[2 * e];
    Rail& end = out.rails[2 * e + 1];
    begin.splits = end.splits = edge.splits();
    join(begin, 0, edge.corner[0], 0, out);
    join(end, 0, next[edge.corner[0]], 3, out);
    if (edge.border()) continue;
    join(end, 1, edge.corner[1], 0, out);
    join(begin, 1, next[edge.corner[1]], 3, out);
  }
  for (std::uint32_t c = 0; c < cage.vertex.size(); ++c) {
    Rail& inner = out.rails[2 * cage.edges.size() + c];
    join(inner, 0, c, 1, out);
    join(inner, 1, next[c], 2, out);
  }
  return out;
}

}  // namespace

Cells cells_of(const Subdiv& shape, const Cage& cage) {
  Cells out = cage.all_quads ? whole_faces(shape, cage) : quarters(shape, cage);
  out.textured = std::any_of(shape.faces.begin(), shape.faces.end(),
                             [](const Subdiv::Face& f) { return !f.texcoords.empty(); });
  return out;
}

Vec2 on_side(std::uint32_t side, double t) {
  switch (side) {
    case 0:
      return {t, 0};
    case 1:
      return {1, t};
    case 2:
      return {1 - t, 1};
    default:
      return {0, 1 - t};
  }
}

bool CellSurface::evaluate(const Cell& cell, const Vec2& at, LimitPoint& out) const {
  const Vec2 uv = glm::clamp(cell.origin + at.x * cell.along + at.y * cell.up, Vec2(0), Vec2(1));
  LimitPoint p;
  if (!limit_.evaluate(cell.patch, uv.x, uv.y, p)) return false;
  out.position = p.position;
  out.du = cell.along.x * p.du + cell.along.y * p.dv;
  out.dv = cell.up.x * p.du + cell.up.y * p.dv;
  return true;
}

CornerLimit CellSurface::corner(const Cell& cell, std::uint32_t which) const {
  LimitPoint p;
  if (evaluate(cell, kCorners[which], p)) return {p.position, normal_of(p)};
  // note: middles of sides are regular
  return cell.quarter && which == 2
             ? limit_.at_centre(cell.face, cell.corner)
             : limit_.at_corner(cell.face, cell.quarter ? cell.corner : which);
}

Vec3 normal_of(const LimitPoint& point) {
  const Vec3 n = glm::cross(point.du, point.dv);
  const double length = glm::length(n);
  // shorter ones are made of rounding
  const double scale = glm::length(point.du) * glm::length(point.dv);
  return length > 1e-9 * scale ? n / length : Vec3(0);
}

}  // namespace panwright::geometry::internal
