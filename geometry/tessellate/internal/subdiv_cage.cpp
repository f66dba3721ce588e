#include "geometry/tessellate/internal/subdiv_cage.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/axis_box.h"
#include "base/text.h"
#include "geometry/tessellate/internal/flat.h"

namespace panwright::geometry::internal {

namespace {

// what subdivision keeps the sides of a face and the faces of a vertex in
constexpr std::uint32_t kMostSides = 10000;

ShapeProblem cage_problem(Code code, std::string_view part, std::size_t item,
                          const std::string& what, std::size_t sub_item = 0) {
  const std::string_view one = part == "faces" ? "face" : part == "creases" ? "crease" : "corner";
  return {code, fmt::format("{} {}: {}", one, item + 1, what), part, item, sub_item};
}

Problem vertex_problem(const Subdiv& shape, const std::vector<std::uint32_t>& list,
                       std::string_view part, std::size_t item) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i] >= shape.positions.size())
      return cage_problem(
          Code("E2001"), part, item,
          fmt::format("vertex index {}, expected below {}", list[i], shape.positions.size()), i);
  return std::nullopt;
}

Problem sharpness_problem(double sharpness, std::string_view part, std::size_t item) {
  if (sharpness >= 0 && sharpness <= kInfinitelySharp) return std::nullopt;
  return cage_problem(Code("E2011"), part, item,
                      fmt::format("a sharpness of {}, expected 0 to {}", format_double(sharpness),
                                  format_double(kInfinitelySharp)));
}

Problem face_problem(const Subdiv& shape, std::size_t index) {
  const Subdiv::Face& face = shape.faces[index];
  if (face.outline.size() < 3 || face.outline.size() > kMostSides)
    return cage_problem(Code("E2015"), "faces", index,
                        fmt::format("an outline of {} vertices, expected 3 to {}",
                                    face.outline.size(), kMostSides));
  if (auto bad = vertex_problem(shape, face.outline, "faces", index)) return bad;
  std::vector<std::uint32_t> sorted = face.outline;
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
    return cage_problem(
        Code("E2015"), "faces", index,
        fmt::format("its outline has vertex {} twice, expected each vertex once", *twice));
  if (!face.texcoords.empty() && face.texcoords.size() != face.outline.size())
    return cage_problem(Code("E2002"), "faces", index,
                        fmt::format("{} texture coordinates for {} corners, expected one for each",
                                    face.texcoords.size(), face.outline.size()));
  for (const std::uint32_t t : face.texcoords)
    if (t >= shape.texcoords.size())
      return cage_problem(
          Code("E2001"), "faces", index,
          fmt::format("texture coordinate index {}, expected below {}", t, shape.texcoords.size()));
  return std::nullopt;
}

struct Side {
  std::uint32_t low, high;  // vertices
  std::uint32_t corner;
  std::uint32_t face;
  bool forward;  // runs from the lower vertex
};

std::vector<Side> sorted_sides(const Cage& cage) {
  std::vector<Side> sides;
  sides.reserve(cage.vertex.size());
  for (std::uint32_t f = 0; f < cage.faces(); ++f)
    for (std::uint32_t c = cage.first[f]; c < cage.first[f + 1]; ++c) {
      const std::uint32_t a = cage.vertex[c], b = cage.vertex[cage.next(f, c)];
      sides.push_back({std::min(a, b), std::max(a, b), c, f, a < b});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.low != b.low     ? a.low < b.low
           : a.high != b.high ? a.high < b.high
                              : a.corner < b.corner;
  });
  return sides;
}

// Two sides or one at each edge, that run opposite ways.
Problem add_edges(Cage& cage) {
  const std::vector<Side> sides = sorted_sides(cage);
  cage.edge.resize(cage.vertex.size());
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high)
      ++end;
    const Side& one = sides[i];
    if (end - i > 2)
      return cage_problem(
          Code("E2026"), "faces", sides[i + 2].face,
          fmt::format("{} faces meet at its edge from vertex {} to {}, expected at most 2", end - i,
                      one.low, one.high));
    if (end - i == 2 && one.forward == sides[i + 1].forward)
      return cage_problem(Code("E2026"), "faces", sides[i + 1].face,
                          fmt::format("it runs along its edge from vertex {} to {} the same way as "
                                      "face {}, expected outlines counter-clockwise from outside",
                                      one.low, one.high, one.face + 1));
    const auto number = static_cast<std::uint32_t>(cage.edges.size());
    for (std::size_t k = i; k < end; ++k) cage.edge[sides[k].corner] = number;
    Cage::Edge edge{
        one.low, one.high, {one.corner, end - i == 2 ? sides[i + 1].corner : kNoCorner}};
    if (!one.forward) std::swap(edge.a, edge.b);
    cage.edges.push_back(edge);
    i = end;
  }
  return std::nullopt;
}

// The faces at a vertex are one fan: turning about it from one of them reaches all.
Problem fan_problem(const Cage& cage, std::size_t vertices) {
  std::vector<std::uint32_t> face_of(cage.vertex.size()), count(vertices, 0);
  std::vector<std::uint32_t> some(vertices, kNoCorner);
  for (std::uint32_t f = 0; f < cage.faces(); ++f)
    for (std::uint32_t c = cage.first[f]; c < cage.first[f + 1]; ++c) {
      face_of[c] = f;
      ++count[cage.vertex[c]];
      some[cage.vertex[c]] = c;
    }
  const auto previous = [&](std::uint32_t c) {
    const std::uint32_t f = face_of[c];
    return c == cage.first[f] ? cage.first[f + 1] - 1 : c - 1;
  };
  const auto across = [&](std::uint32_t side) {
    const Cage::Edge& e = cage.edges[cage.edge[side]];
    return e.corner[0] == side ? e.corner[1] : e.corner[0];
  };
  for (std::size_t v = 0; v < vertices; ++v) {
    const std::uint32_t begin = some[v];
    if (begin == kNoCorner) continue;
    std::uint32_t met = 1;
    std::uint32_t c = begin;
    // counter-clockwise: across the side that ends here
    while ((c = across(previous(c))) != kNoCorner && c != begin) ++met;
    if (c == kNoCorner)
      for (c = begin; (c = across(c)) != kNoCorner; ++met) c = cage.next(face_of[c], c);
    if (count[v] > kMostSides)
      return cage_problem(Code("E2026"), "faces", face_of[begin],
                          fmt::format("{} faces meet at its vertex {}, expected at most {}",
                                      count[v], v, kMostSides));
    if (met != count[v])
      return cage_problem(Code("E2026"), "faces", face_of[begin],
                          fmt::format("at its vertex {} faces meet that share no edge there, "
                                      "expected a vertex of its own for each part",
                                      v));
  }
  return std::nullopt;
}

Problem add_creases(const Subdiv& shape, Cage& cage) {
  for (std::size_t i = 0; i < shape.creases.size(); ++i) {
    const Subdiv::Crease& crease = shape.creases[i];
    if (crease.path.size() < 2)
      return cage_problem(Code("E2015"), "creases", i,
                          fmt::format("{} vertices, expected at least 2", crease.path.size()));
    if (auto bad = vertex_problem(shape, crease.path, "creases", i)) return bad;
    if (auto bad = sharpness_problem(crease.sharpness, "creases", i)) return bad;
    for (std::size_t k = 0; k + 1 < crease.path.size(); ++k) {
      const auto [low, high] = std::minmax(crease.path[k], crease.path[k + 1]);
      const auto found = std::lower_bound(
          cage.edges.begin(), cage.edges.end(), std::pair(low, high),
          [](const Cage::Edge& e, const std::pair<std::uint32_t, std::uint32_t>& key) {
            return std::pair(std::min(e.a, e.b), std::max(e.a, e.b)) < key;
          });
      if (found == cage.edges.end() || std::min(found->a, found->b) != low ||
          std::max(found->a, found->b) != high)
        return cage_problem(Code("E2027"), "creases", i,
                            fmt::format("no face has an edge from vertex {} to {}", crease.path[k],
                                        crease.path[k + 1]),
                            k + 1);
      // note: of several the sharpest
      found->sharpness = std::max(found->sharpness, static_cast<float>(crease.sharpness));
    }
  }
  return std::nullopt;
}

Problem add_corners(const Subdiv& shape, Cage& cage) {
  cage.vertex_sharpness.assign(shape.positions.size(), 0);
  for (std::size_t i = 0; i < shape.corners.size(); ++i) {
    const Subdiv::Corner& corner = shape.corners[i];
    if (auto bad = vertex_problem(shape, corner.vertices, "corners", i)) return bad;
    if (auto bad = sharpness_problem(corner.sharpness, "corners", i)) return bad;
    for (const std::uint32_t v : corner.vertices)
      cage.vertex_sharpness[v] =
          std::max(cage.vertex_sharpness[v], static_cast<float>(corner.sharpness));
  }
  return std::nullopt;
}

Problem extent_problem(const Subdiv& shape, const Cage& cage) {
  AxisBox box;
  for (const std::uint32_t v : cage.vertex) box.add(shape.positions[v]);
  const double largest = box.longest();
  if (largest >= kMinRadius) return std::nullopt;
  return ShapeProblem{largest > 0 ? Code("E2010") : Code("E2011"),
                      fmt::format("a cage with an extent of {} m, expected at least {} m",
                                  format_double(largest), format_double(kMinRadius)),
                      "positions"};
}

}  // namespace

Problem read_cage(const Subdiv& shape, Cage& cage) {
  cage = {};
  cage.first.push_back(0);
  for (std::size_t i = 0; i < shape.faces.size(); ++i) {
    if (auto bad = face_problem(shape, i)) return bad;
    const auto& outline = shape.faces[i].outline;
    cage.vertex.insert(cage.vertex.end(), outline.begin(), outline.end());
    cage.first.push_back(static_cast<std::uint32_t>(cage.vertex.size()));
    cage.all_quads &= outline.size() == 4;
    if (shape.faces[i].texcoords.empty() != shape.faces[0].texcoords.empty())
      return cage_problem(Code("E2002"), "faces", i,
                          fmt::format("it has {}texture coordinates, and face 1 has {}",
                                      shape.faces[i].texcoords.empty() ? "no " : "",
                                      shape.faces[i].texcoords.empty() ? "some" : "none"));
  }
  if (auto bad = add_edges(cage)) return bad;
  if (auto bad = fan_problem(cage, shape.positions.size())) return bad;
  if (auto bad = add_creases(shape, cage)) return bad;
  return add_corners(shape, cage);
}

int sharp_levels(const Cage& cage) {
  float most = 0;
  const auto look_at = [&](float sharpness) {
    if (sharpness < static_cast<float>(kInfinitelySharp)) most = std::max(most, sharpness);
  };
  for (const Cage::Edge& e : cage.edges)
    if (!e.border()) look_at(e.sharpness);
  for (const float s : cage.vertex_sharpness) look_at(s);
  return static_cast<int>(std::ceil(most));
}

Problem problem(const Subdiv& shape) {
  if (auto bad = coordinate_problem(shape.positions, "positions")) return bad;
  if (auto bad = coordinate_problem(shape.texcoords, "texcoords")) return bad;
  if (shape.levels > Subdiv::kMaxLevels)
    return ShapeProblem{
        Code("E2011"),
        fmt::format("{} levels, expected at most {}", shape.levels, Subdiv::kMaxLevels), "levels"};
  if (shape.faces.empty())
    return ShapeProblem{Code("E2015"), "no faces, expected at least 1", "faces"};
  Cage cage;
  if (auto bad = read_cage(shape, cage)) return bad;
  return extent_problem(shape, cage);
}

bool has_no_border(const Subdiv& shape) {
  Cage cage;
  if (read_cage(shape, cage)) return false;
  return std::none_of(cage.edges.begin(), cage.edges.end(),
                      [](const Cage::Edge& e) { return e.border(); });
}

}  // namespace panwright::geometry::internal
