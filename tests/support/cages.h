// Cages of subdivision surfaces, for tests and benches.
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "geometry/tessellate/shape.h"

namespace panwright::cages {

using geometry::Subdiv;

inline void add_faces(Subdiv& s, const std::vector<std::vector<std::uint32_t>>& faces) {
  for (const auto& face : faces) s.faces.push_back({face, {}});
}

// The cube [-1, 1]³.
inline Subdiv cube() {
  Subdiv s;
  for (int i = 0; i < 8; ++i)
    s.positions.push_back({i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
  add_faces(s,
            {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
  return s;
}

// A tetrahedron with one corner cut off: triangles and quadrilaterals.
inline Subdiv wedge() {
  Subdiv s;
  s.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.4, 0.4, 1.5}, {1, 0.4, 1.3}, {0.4, 1, 1.2}};
  add_faces(s, {{0, 2, 1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}, {3, 4, 5}});
  return s;
}

// A prism of n sides with a face of n sides at either end.
inline Subdiv prism(std::uint32_t n) {
  Subdiv s;
  std::vector<std::uint32_t> bottom, top;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * M_PI * i / n;
    for (const double z : {-0.7, 0.8}) s.positions.push_back({std::cos(a), std::sin(a) * 1.2, z});
    bottom.insert(bottom.begin(), 2 * i);
    top.push_back(2 * i + 1);
    const std::uint32_t k = (i + 1) % n;
    s.faces.push_back({{2 * i, 2 * k, 2 * k + 1, 2 * i + 1}, {}});
  }
  s.faces.push_back({bottom, {}});
  s.faces.push_back({top, {}});
  return s;
}

// Two fans of n triangles about poles: valence n there.
inline Subdiv bipyramid(std::uint32_t n) {
  Subdiv s;
  s.positions = {{0, 0, -1}, {0.1, 0, 1}};
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * M_PI * i / n;
    s.positions.push_back({std::cos(a), std::sin(a), 0.1 * std::sin(3 * a)});
    const std::uint32_t here = 2 + i, next = 2 + (i + 1) % n;
    s.faces.push_back({{here, next, 1}, {}});
    s.faces.push_back({{next, here, 0}, {}});
  }
  return s;
}

// Quadrilaterals over [0, n] × [0, m] with heights by a formula.
inline Subdiv sheet(std::uint32_t n, std::uint32_t m, double height = 0.6) {
  Subdiv s;
  for (std::uint32_t j = 0; j <= m; ++j)
    for (std::uint32_t i = 0; i <= n; ++i)
      s.positions.push_back({static_cast<double>(i), static_cast<double>(j),
                             height * std::sin(1.3 * i + 0.7 * j) * std::cos(0.9 * j)});
  for (std::uint32_t j = 0; j < m; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i;
      s.faces.push_back({{a, a + 1, a + n + 2, a + n + 1}, {}});
    }
  return s;
}

// Two boxes that meet at a right angle, with valences 3 to 5.
inline Subdiv elbow() {
  Subdiv s;
  std::map<std::vector<int>, std::uint32_t> known;
  const auto vertex = [&](int x, int y, int z) {
    const auto [at, added] =
        known.emplace(std::vector{x, y, z}, static_cast<std::uint32_t>(s.positions.size()));
    if (added) s.positions.push_back({1.0 * x, 1.1 * y, 0.9 * z});
    return at->second;
  };
  const std::vector<std::vector<int>> blocks = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto filled = [&](int x, int y, int z) {
    for (const auto& b : blocks)
      if (b[0] == x && b[1] == y && b[2] == z) return true;
    return false;
  };
  for (const auto& b : blocks)
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        int next[3] = {b[0], b[1], b[2]};
        next[axis] += side == 1 ? 1 : -1;
        if (filled(next[0], next[1], next[2])) continue;
        std::vector<std::uint32_t> face;
        for (const auto& [u, v] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
          int p[3] = {b[0], b[1], b[2]};
          p[axis] += side;
          p[(axis + 1) % 3] += u;
          p[(axis + 2) % 3] += v;
          face.push_back(vertex(p[0], p[1], p[2]));
        }
        if (side == 0) face = {face[0], face[3], face[2], face[1]};
        s.faces.push_back({face, {}});
      }
  return s;
}

struct Named {
  std::string name;
  Subdiv shape;
};

inline Subdiv creased(Subdiv s, std::vector<std::uint32_t> path, double sharpness) {
  s.creases.push_back({std::move(path), sharpness});
  return s;
}
inline Subdiv cornered(Subdiv s, std::vector<std::uint32_t> vertices, double sharpness) {
  s.corners.push_back({std::move(vertices), sharpness});
  return s;
}

// Irregular vertices, borders of both kinds, creases and corners, finite and not.
inline std::vector<Named> all() {
  constexpr double kSharp = geometry::kInfinitelySharp;
  std::vector<Named> out = {{"cube", cube()},         {"wedge", wedge()},
                            {"prism of 5", prism(5)}, {"bipyramid of 7", bipyramid(7)},
                            {"sheet", sheet(4, 3)},   {"elbow", elbow()}};
  Subdiv smooth = sheet(3, 3);
  smooth.smooth_border = true;
  out.push_back({"sheet with a smooth border", smooth});
  Subdiv fan = bipyramid(6);
  for (std::size_t i = fan.faces.size(); i-- > 0;)
    if (i % 2 == 1 || i < 2) fan.faces.erase(fan.faces.begin() + static_cast<std::ptrdiff_t>(i));
  out.push_back({"open fan of triangles", fan});
  fan.smooth_border = true;
  out.push_back({"open fan with a smooth border", fan});
  out.push_back({"cube, ring of creases", creased(cube(), {4, 5, 7, 6, 4}, kSharp)});
  out.push_back({"cube, ring of 1.5", creased(cube(), {4, 5, 7, 6, 4}, 1.5)});
  out.push_back({"cube, ring of 3", creased(cube(), {4, 5, 7, 6, 4}, 3)});
  out.push_back({"cube, dart", creased(cube(), {4, 5, 7}, kSharp)});
  out.push_back({"cube, three creases at a corner",
                 creased(creased(cube(), {4, 5, 7, 6, 4}, kSharp), {1, 5}, kSharp)});
  out.push_back(
      {"cube, mixed creases",
       creased(creased(creased(cube(), {4, 5, 7, 6, 4}, 0.75), {1, 5}, 2.25), {0, 1}, 1)});
  out.push_back({"cube, sharp corner", cornered(cube(), {7}, kSharp)});
  out.push_back({"cube, corner of 2.5", cornered(cube(), {7}, 2.5)});
  out.push_back({"prism of 5, ring", creased(prism(5), {1, 3, 5, 7, 9, 1}, kSharp)});
  out.push_back({"prism of 6, ring of 0.5", creased(prism(6), {1, 3, 5, 7, 9, 11, 1}, 0.5)});
  out.push_back({"sheet with a crease inside", creased(sheet(4, 4), {7, 12, 17}, kSharp)});
  out.push_back({"sheet with a crease across", creased(sheet(4, 4), {2, 7, 12, 17, 22}, kSharp)});
  out.push_back(
      {"elbow, creases", creased(elbow(),
                                 {elbow().faces[0].outline[0], elbow().faces[0].outline[1],
                                  elbow().faces[0].outline[2]},
                                 2)});
  return out;
}

}  // namespace panwright::cages
