#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "base/axis_box.h"
#include "base/text.h"
#include "geometry/internal/triangle.h"
#include "geometry/internal/weld.h"
#include "geometry/tessellate/internal/subdiv_cage.h"

namespace panwright::geometry::internal {

namespace {

struct FaceArea {
  Vec3 area{0};
  double longest = 0;  // no less than its longest diagonal
};

FaceArea area_of(const Subdiv& shape, const Subdiv::Face& face) {
  FaceArea out;
  const Vec3& origin = shape.positions[face.outline[0]];
  AxisBox box{origin, origin};
  for (std::size_t i = 1; i < face.outline.size(); ++i) {
    const Vec3& p = shape.positions[face.outline[i]];
    box.add(p);
    if (i + 1 < face.outline.size())
      out.area += 0.5 * glm::cross(p - origin, shape.positions[face.outline[i + 1]] - origin);
  }
  out.longest = box.diagonal();
  return out;
}

void look_at_faces(const Subdiv& shape, bool closed, std::vector<ShapeProblem>& out) {
  std::uint64_t thin = 0;
  std::size_t first = 0;
  double volume = 0, extent = 0;
  const Vec3& origin = shape.positions[shape.faces[0].outline[0]];
  for (std::size_t i = 0; i < shape.faces.size(); ++i) {
    const FaceArea face = area_of(shape, shape.faces[i]);
    const double area = glm::length(face.area);
    if (2 * area <= kDegenerateRatio * face.longest * face.longest && thin++ == 0) first = i;
    const Vec3 to_face = shape.positions[shape.faces[i].outline[0]] - origin;
    volume += glm::dot(face.area, to_face) / 3;
    extent += area * (glm::length(to_face) + face.longest);
  }
  if (thin > 0)
    out.push_back({Code("W2006"),
                   fmt::format("face {}{} no area", first + 1,
                               thin > 1 ? fmt::format(" and {} more have", thin - 1) : " has"),
                   "faces", first});
  // sheets of two faces enclose nothing, but for rounding
  if (closed && volume < -1e-12 * extent)
    out.push_back({Code("W2009"),
                   fmt::format("the cage is closed and inside out: it encloses {:.4g} m³", volume),
                   "subdiv"});
}

// Borders that lie on each other.
void look_at_borders(const Subdiv& shape, const Cage& cage, std::vector<ShapeProblem>& out) {
  const std::vector<std::uint32_t> place = welded(shape.positions);
  struct Border {
    std::uint32_t low, high;  // places
    std::uint32_t a, b;       // vertices there
    std::uint32_t corner;
  };
  std::vector<Border> borders;
  for (const Cage::Edge& e : cage.edges) {
    if (!e.border()) continue;
    Border border{place[e.a], place[e.b], e.a, e.b, e.corner[0]};
    if (border.low > border.high) {
      std::swap(border.low, border.high);
      std::swap(border.a, border.b);
    }
    borders.push_back(border);
  }
  std::stable_sort(borders.begin(), borders.end(), [](const Border& a, const Border& b) {
    return std::pair(a.low, a.high) < std::pair(b.low, b.high);
  });
  const Border* found = nullptr;
  std::uint64_t count = 0;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i)
    if (borders[i].low == borders[i + 1].low && borders[i].high == borders[i + 1].high &&
        count++ == 0)
      found = &borders[i];
  if (found == nullptr) return;
  const auto face = static_cast<std::size_t>(
      std::upper_bound(cage.first.begin(), cage.first.end(), (found + 1)->corner) -
      cage.first.begin() - 1);
  out.push_back(
      {Code("W2028"),
       fmt::format("the surface is open at {} of its cage where two borders coincide: vertices {} "
                   "and {} equal {} and {}",
                   counted(count, "edge"), found->a, found->b, (found + 1)->a, (found + 1)->b),
       "faces", face});
}

}  // namespace

std::vector<ShapeProblem> warnings(const Subdiv& shape) {
  std::vector<ShapeProblem> out;
  Cage cage;
  if (read_cage(shape, cage)) return out;
  const bool closed = std::none_of(cage.edges.begin(), cage.edges.end(),
                                   [](const Cage::Edge& e) { return e.border(); });
  look_at_faces(shape, closed, out);
  look_at_borders(shape, cage, out);
  return out;
}

}  // namespace panwright::geometry::internal

namespace panwright::geometry {

CageTurn turn_of(const Subdiv& shape) {
  CageTurn turn;
  internal::Cage cage;
  if (internal::read_cage(shape, cage)) return turn;
  std::vector<Vec3> normals;
  std::vector<std::uint32_t> face_of;
  for (std::size_t f = 0; f < cage.faces(); ++f) {
    normals.push_back(internal::area_of(shape, shape.faces[f]).area);
    turn.area += glm::length(normals.back());
    face_of.insert(face_of.end(), cage.sides(f), static_cast<std::uint32_t>(f));
  }
  for (const internal::Cage::Edge& e : cage.edges) {
    if (e.border()) continue;
    const Vec3 &one = normals[face_of[e.corner[0]]], &other = normals[face_of[e.corner[1]]];
    turn.mean_curvature +=
        0.5 * glm::length(shape.positions[e.b] - shape.positions[e.a]) * angle_between(one, other);
  }
  return turn;
}

}  // namespace panwright::geometry
