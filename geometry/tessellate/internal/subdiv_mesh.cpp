#include "geometry/tessellate/internal/subdiv_mesh.h"

#include <algorithm>
#include <numeric>

#include "base/parallel.h"
#include "geometry/tessellate/internal/subdiv_deviation.h"

namespace panwright::geometry::internal {

namespace {

// cells and rails that one task handles
constexpr std::size_t kTask = 16;
// of two diagonals the second is taken where it is shorter by more than rounding
constexpr double kShorter = 1 - 1e-9;

template <class Body>
void in_tasks(std::size_t count, const Body& body) {
  parallel_for((count + kTask - 1) / kTask, [&](std::size_t task) {
    for (std::size_t i = task * kTask; i < std::min(count, (task + 1) * kTask); ++i) body(i);
  });
}

class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

// Of a cell with so many segments on its sides.
struct CellGrid {
  CellGrid(const Cell& cell, const std::vector<std::uint32_t>& rates) {
    for (std::uint32_t side = 0; side < 4; ++side) rate[side] = rates[cell.rail[side]];
    u = std::max(rate[0], rate[2]);
    v = std::max(rate[1], rate[3]);
  }
  bool has_inside() const { return u > 1 && v > 1; }
  std::uint64_t inner_vertices() const { return std::uint64_t{u - 1} * (v - 1); }
  std::uint64_t triangles() const {
    if (!has_inside()) return u > 1 ? rate[0] + rate[2] : rate[1] + rate[3];
    const std::uint64_t strips = std::uint64_t{rate[0]} + rate[1] + rate[2] + rate[3];
    return 2 * std::uint64_t{u - 2} * (v - 2) + strips + 2 * std::uint64_t{u - 2} +
           2 * std::uint64_t{v - 2};
  }

  std::uint32_t rate[4];
  std::uint32_t u, v;
};

class CellMesher {
 public:
  CellMesher(const CellSurface& surface, const std::vector<std::uint32_t>& rates, bool texcoords)
      : surface_(surface),
        all_(surface.cells()),
        rates_(rates),
        texcoords_(texcoords && all_.textured) {}

  CellMesh run() {
    number_corners();
    number_rails();
    number_cells();
    Mesh& mesh = out_.mesh;
    mesh.positions.resize(vertices_);
    mesh.normals.resize(vertices_);
    if (texcoords_) mesh.texcoords.resize(vertices_);
    mesh.triangles.resize(triangles_);
    out_.errors.resize(all_.cells.size());
    place_corners();
    in_tasks(all_.rails.size(), [&](std::size_t i) { place_rail(i); });
    in_tasks(all_.cells.size(), [&](std::size_t i) { place_inside(i); });
    in_tasks(all_.cells.size(), [&](std::size_t i) { cut(i); });
    mend_normals();
    mesh.closed = std::none_of(all_.rails.begin(), all_.rails.end(),
                               [](const Rail& r) { return r.border(); });
    return std::move(out_);
  }

 private:
  // ---- numbers of vertices: corners, then rails, then the insides of cells

  static std::uint32_t slot(std::size_t cell, std::uint32_t corner) {
    return static_cast<std::uint32_t>(4 * cell + corner % 4);
  }
  const Vec2& texcoord(std::uint32_t slot) const { return all_.cells[slot / 4].texcoord[slot % 4]; }

  void number_corners() {
    Groups sectors(4 * all_.cells.size()), same(4 * all_.cells.size());
    shared_.resize(all_.rails.size());
    for (std::size_t i = 0; i < all_.rails.size(); ++i) {
      const Rail& rail = all_.rails[i];
      if (rail.splits) continue;
      bool both = true;
      for (const std::uint32_t end : {0u, 1u}) {
        const std::uint32_t a = slot(rail.cell[0], rail.side[0] + end);
        const std::uint32_t b = slot(rail.cell[1], rail.side[1] + 1 - end);
        sectors.join(a, b);
        const bool equal = !texcoords_ || texcoord(a) == texcoord(b);
        if (equal) same.join(a, b);
        both &= equal;
      }
      shared_[i] = both;
    }
    corner_.resize(4 * all_.cells.size());
    sector_.resize(4 * all_.cells.size());
    for (std::uint32_t i = 0; i < corner_.size(); ++i) {
      sector_[i] = sectors.root(i);
      corner_[i] =
          same.root(i) == i ? static_cast<std::uint32_t>(vertices_++) : corner_[same.root(i)];
    }
  }

  void number_rails() {
    rail_start_.resize(2 * all_.rails.size());
    for (std::size_t i = 0; i < all_.rails.size(); ++i) {
      rail_start_[2 * i] = rail_start_[2 * i + 1] = vertices_;
      vertices_ += rates_[i] - 1;
      if (all_.rails[i].border() || shared_[i]) continue;
      rail_start_[2 * i + 1] = vertices_;
      vertices_ += rates_[i] - 1;
    }
  }

  void number_cells() {
    for (const Cell& cell : all_.cells) {
      const CellGrid grid(cell, rates_);
      inner_start_.push_back(vertices_);
      first_triangle_.push_back(triangles_);
      vertices_ += grid.inner_vertices();
      triangles_ += grid.triangles();
    }
  }

  // ---- their places

  void set(std::uint64_t vertex, const Vec3& position, const Vec3& normal, const Cell& cell,
           const Vec2& at) {
    out_.mesh.positions[vertex] = position;
    out_.mesh.normals[vertex] = normal;
    if (!texcoords_) return;
    const Vec2(&t)[4] = cell.texcoord;
    out_.mesh.texcoords[vertex] =
        (1 - at.y) * ((1 - at.x) * t[0] + at.x * t[1]) + at.y * ((1 - at.x) * t[3] + at.x * t[2]);
  }

  void place_corners() {
    std::vector<std::uint32_t> first(all_.places, Rail::kNone);  // vertex at each place
    for (std::uint32_t i = 0; i < corner_.size(); ++i) {
      const Cell& cell = all_.cells[i / 4];
      const bool leads = sector_[i] == i;
      if (leads) {
        const CornerLimit limit = surface_.corner(cell, i % 4);
        std::uint32_t& known = first[cell.place[i % 4]];
        // one position, whatever the sector that it is seen from
        const Vec3 position = known == Rail::kNone ? limit.position : out_.mesh.positions[known];
        if (known == Rail::kNone) known = corner_[i];
        set(corner_[i], position, limit.normal, cell, on_side(i % 4, 0));
      } else if (corner_[i] != corner_[sector_[i]]) {
        const std::uint32_t like = corner_[sector_[i]];
        set(corner_[i], Vec3(out_.mesh.positions[like]), Vec3(out_.mesh.normals[like]), cell,
            on_side(i % 4, 0));
      }
    }
  }

  void place_rail(std::size_t index) {
    const Rail& rail = all_.rails[index];
    const std::uint32_t count = rates_[index];
    for (std::uint32_t j = 1; j < count; ++j) {
      const std::uint64_t vertex = rail_start_[2 * index] + j - 1;
      LimitPoint p;
      place_on_rail(rail, 0, j, count, vertex, p);
      const std::uint64_t other = rail_start_[2 * index + 1] + j - 1;
      if (other == vertex) continue;
      const Vec3 position = p.position;
      place_on_rail(rail, 1, j, count, other, p);
      out_.mesh.positions[other] = position;
      // across a seam of texture coordinates the surface is one
      if (!rail.splits) out_.mesh.normals[other] = Vec3(out_.mesh.normals[vertex]);
    }
  }

  void place_on_rail(const Rail& rail, std::uint32_t which, std::uint32_t j, std::uint32_t count,
                     std::uint64_t vertex, LimitPoint& p) {
    const Cell& cell = all_.cells[rail.cell[which]];
    const double t = static_cast<double>(which == 0 ? j : count - j) / count;
    const Vec2 at = on_side(rail.side[which], t);
    p = {};
    surface_.evaluate(cell, at, p);
    set(vertex, p.position, normal_of(p), cell, at);
  }

  void place_inside(std::size_t index) {
    const Cell& cell = all_.cells[index];
    const CellGrid grid(cell, rates_);
    if (!grid.has_inside()) return;
    std::uint64_t vertex = inner_start_[index];
    for (std::uint32_t j = 1; j < grid.v; ++j)
      for (std::uint32_t i = 1; i < grid.u; ++i) {
        const Vec2 at = Vec2(i, j) / Vec2(grid.u, grid.v);
        LimitPoint p;
        surface_.evaluate(cell, at, p);
        set(vertex++, p.position, normal_of(p), cell, at);
      }
  }

  // ---- triangles of one cell

  struct Cutter {
    const CellMesher& mesher;
    std::size_t index;
    const Cell& cell;
    CellGrid grid;
    CellDeviation deviation;
    Triangle* next;

    const Vec3& position(const CellNode& n) const { return mesher.out_.mesh.positions[n.vertex]; }

    void triangle(const CellNode& a, const CellNode& b, const CellNode& c) {
      *next++ = {a.vertex, b.vertex, c.vertex};
      deviation.show({a.at, b.at, c.at}, {position(a), position(b), position(c)});
    }

    bool second_is_shorter(const CellNode& a, const CellNode& b, const CellNode& c,
                           const CellNode& d) const {
      return glm::length(position(d) - position(b)) <
             kShorter * glm::length(position(c) - position(a));
    }

    CellNode inner(std::uint32_t i, std::uint32_t j) const {
      return {static_cast<std::uint32_t>(mesher.inner_start_[index] +
                                         std::uint64_t{j - 1} * (grid.u - 1) + (i - 1)),
              Vec2(i, j) / Vec2(grid.u, grid.v)};
    }

    // the vertices of a side, along it
    std::vector<CellNode> side(std::uint32_t s) const {
      const std::uint32_t count = grid.rate[s];
      const std::uint32_t rail = cell.rail[s];
      const Rail& r = mesher.all_.rails[rail];
      const bool second = r.cell[1] == index && r.side[1] == s;
      std::vector<CellNode> nodes;
      for (std::uint32_t j = 0; j <= count; ++j) {
        const Vec2 at = on_side(s, static_cast<double>(j) / count);
        if (j == 0 || j == count) {
          nodes.push_back({mesher.corner_[slot(index, s + (j == 0 ? 0 : 1))], at});
        } else {
          const std::uint32_t along = second ? count - j : j;
          nodes.push_back({static_cast<std::uint32_t>(
                               mesher.rail_start_[2 * rail + (second ? 1 : 0)] + along - 1),
                           at});
        }
      }
      return nodes;
    }

    // the inner vertices next to a side, along it
    std::vector<CellNode> beside(std::uint32_t s) const {
      std::vector<CellNode> nodes;
      const std::uint32_t count = (s % 2 == 0 ? grid.u : grid.v) - 1;
      for (std::uint32_t k = 1; k <= count; ++k) {
        const std::uint32_t back = count + 1 - k;
        nodes.push_back(s == 0   ? inner(k, 1)
                        : s == 1 ? inner(grid.u - 1, k)
                        : s == 2 ? inner(back, grid.v - 1)
                                 : inner(1, back));
      }
      return nodes;
    }

    // Between an outer line on the right and an inner one on the left, which begins `shift` of its
    // `total` segments along: the segment comes next whose middle does.
    void strip(const std::vector<CellNode>& outer, const std::vector<CellNode>& in,
               std::uint64_t total, std::uint64_t shift) {
      const std::size_t outer_count = outer.size() - 1, in_count = in.size() - 1;
      std::size_t i = 0, k = 0;
      while (i < outer_count || k < in_count) {
        const std::uint64_t here = (2 * i + 1) * total;
        const std::uint64_t there = (2 * (k + shift) + 1) * outer_count;
        bool along_outer = k == in_count || (i < outer_count && here <= there);
        if (along_outer && k < in_count && here == there)
          along_outer = !second_is_shorter(outer[i + 1], outer[i], in[k], in[k + 1]);
        if (along_outer) {
          triangle(outer[i], outer[i + 1], in[k]);
          ++i;
        } else {
          triangle(outer[i], in[k + 1], in[k]);
          ++k;
        }
      }
    }

    void run() {
      if (grid.has_inside()) {
        for (std::uint32_t s = 0; s < 4; ++s)
          strip(side(s), beside(s), s % 2 == 0 ? grid.u : grid.v, 1);
        for (std::uint32_t j = 1; j + 1 < grid.v; ++j)
          for (std::uint32_t i = 1; i + 1 < grid.u; ++i) {
            const CellNode a = inner(i, j), b = inner(i + 1, j), c = inner(i + 1, j + 1),
                           d = inner(i, j + 1);
            const bool other = second_is_shorter(a, b, c, d);
            triangle(a, b, other ? d : c);
            triangle(other ? b : a, c, d);
          }
      } else {
        const std::uint32_t s = grid.u > 1 ? 0 : 1;
        std::vector<CellNode> opposite = side(s + 2);
        std::reverse(opposite.begin(), opposite.end());
        strip(side(s), opposite, grid.rate[s + 2], 0);
      }
      for (std::uint32_t s = 0; s < 4; ++s) {
        if (!mesher.all_.rails[cell.rail[s]].splits) continue;
        const std::vector<CellNode> nodes = side(s);
        for (std::size_t k = 0; k + 1 < nodes.size(); ++k)
          deviation.show_curve(nodes[k].at, nodes[k + 1].at, position(nodes[k]),
                               position(nodes[k + 1]));
      }
    }
  };

  void cut(std::size_t index) {
    const Cell& cell = all_.cells[index];
    Cutter cutter{*this,
                  index,
                  cell,
                  CellGrid(cell, rates_),
                  CellDeviation(surface_, cell),
                  out_.mesh.triangles.data() + first_triangle_[index]};
    cutter.run();
    out_.errors[index] = cutter.deviation.worst();
  }

  // Where tangents vanish, normals are those of the triangles.
  void mend_normals() {
    std::vector<Vec3>& normals = out_.mesh.normals;
    const std::vector<Vec3>& p = out_.mesh.positions;
    if (std::none_of(normals.begin(), normals.end(), [](const Vec3& n) { return n == Vec3(0); }))
      return;
    std::vector<Vec3> sums(normals.size(), Vec3(0));
    for (const Triangle& t : out_.mesh.triangles) {
      const Vec3 area = glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
      for (const std::uint32_t v : t)
        if (normals[v] == Vec3(0)) sums[v] += area;
    }
    for (std::size_t i = 0; i < normals.size(); ++i) {
      if (normals[i] != Vec3(0)) continue;
      const double length = glm::length(sums[i]);
      normals[i] = length > 0 ? sums[i] / length : Vec3(0, 0, 1);
    }
  }

  const CellSurface& surface_;
  const Cells& all_;
  const std::vector<std::uint32_t>& rates_;
  bool texcoords_;
  std::vector<char> shared_;                // rails whose cells share vertices
  std::vector<std::uint32_t> corner_;       // 4 a cell: vertices
  std::vector<std::uint32_t> sector_;       // 4 a cell: the first that has the same normal
  std::vector<std::uint64_t> rail_start_;   // 2 a rail: vertices from the first cell's begin on
  std::vector<std::uint64_t> inner_start_;  // of each cell
  std::vector<std::uint64_t> first_triangle_;
  std::uint64_t vertices_ = 0;
  std::uint64_t triangles_ = 0;
  CellMesh out_;
};

}  // namespace

CellCounts counts_of(const Cells& cells, const std::vector<std::uint32_t>& rates) {
  CellCounts counts;
  for (const Cell& cell : cells.cells) {
    const CellGrid grid(cell, rates);
    counts.triangles += static_cast<double>(grid.triangles());
    counts.vertices += static_cast<double>(grid.inner_vertices() + 4);
  }
  for (const std::uint32_t rate : rates) counts.vertices += 2.0 * rate;
  return counts;
}

CellMesh mesh_of(const CellSurface& surface, const std::vector<std::uint32_t>& rates,
                 bool texcoords) {
  return CellMesher(surface, rates, texcoords).run();
}

}  // namespace panwright::geometry::internal
