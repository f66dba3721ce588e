#include "geometry/mesh/face_groups.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

namespace panwright::geometry {
namespace {

// The first vertex within the distance of each; a search over cells of that size.
std::vector<std::uint32_t> first_near(const std::vector<Vec3>& points, const Vec3& low,
                                      double distance) {
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells;
  const auto key = [](const glm::i64vec3& c) {
    const auto part = [](std::int64_t v) { return static_cast<std::uint64_t>(v); };
    return part(c.x) * 0x9E3779B97F4A7C15u ^ part(c.y) * 0xC2B2AE3D27D4EB4Fu ^
           part(c.z) * 0x165667B19E3779F9u;
  };
  std::vector<std::uint32_t> out(points.size());
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    const glm::i64vec3 cell(glm::floor((points[v] - low) / distance));
    std::uint32_t best = kNoNeighbour;
    for (int k = 0; k < 27; ++k) {
      const auto found = cells.find(key(cell + glm::i64vec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
      if (found == cells.end()) continue;
      for (const std::uint32_t other : found->second)
        if (other < best && glm::length(points[other] - points[v]) <= distance) best = other;
    }
    out[v] = std::min(best, v);
    if (best == kNoNeighbour) cells[key(cell)].push_back(v);
  }
  return out;
}

struct DirectedEdge {
  std::uint32_t low, high, triangle;
  std::uint8_t corner;
  bool turned;
  bool operator<(const DirectedEdge& o) const {
    return std::tie(low, high, triangle, corner) < std::tie(o.low, o.high, o.triangle, o.corner);
  }
};

void join(Faces& faces) {
  std::vector<DirectedEdge> edges;
  edges.reserve(faces.triangles.size() * 3);
  for (std::uint32_t t = 0; t < faces.triangles.size(); ++t)
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::uint32_t a = faces.triangles[t][k], b = faces.triangles[t][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, k, a > b});
    }
  std::sort(edges.begin(), edges.end());
  faces.neighbours.assign(faces.triangles.size(), {kNoNeighbour, kNoNeighbour, kNoNeighbour});
  faces.non_manifold.assign(faces.triangles.size(), false);
  for (std::size_t i = 0, end; i < edges.size(); i = end) {
    for (end = i + 1;
         end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high;)
      ++end;
    if (end - i == 1) continue;
    if (end - i == 2 && edges[i].turned != edges[i + 1].turned) {
      faces.neighbours[edges[i].triangle][edges[i].corner] = edges[i + 1].triangle;
      faces.neighbours[edges[i + 1].triangle][edges[i + 1].corner] = edges[i].triangle;
      continue;
    }
    for (std::size_t k = i; k < end; ++k) faces.non_manifold[edges[k].triangle] = true;
  }
}

}  // namespace

Faces chosen_faces(const Mesh& mesh, std::span<const std::uint32_t> chosen, double weld) {
  Faces faces;
  std::vector<std::uint32_t> local(mesh.positions.size(), kNoNeighbour);
  std::vector<Vec3> used;
  for (const std::uint32_t t : chosen)
    for (const std::uint32_t v : mesh.triangles[t])
      if (local[v] == kNoNeighbour) {
        local[v] = static_cast<std::uint32_t>(used.size());
        used.push_back(mesh.positions[v]);
      }
  Vec3 low = used.front(), high = low;
  for (const Vec3& p : used) low = glm::min(low, p), high = glm::max(high, p);
  const double size = glm::length(high - low);
  const double distance = std::max(weld > 0 ? weld : 1e-6 * size, 1e-300);
  const std::vector<std::uint32_t> first = first_near(used, low, distance);
  faces.points = std::move(used);
  for (const std::uint32_t t : chosen) {
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = first[local[mesh.triangles[t][k]]];
    const Vec3 a = faces.points[corners[0]], b = faces.points[corners[1]],
               c = faces.points[corners[2]];
    const Vec3 cross = glm::cross(b - a, c - a);
    const double twice = glm::length(cross);
    const double longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
    if (!(twice > 1e-9 * longest * longest)) {
      ++faces.without_area;
      continue;
    }
    faces.triangles.push_back(corners);
    faces.source.push_back(t);
    faces.normals.push_back(cross / twice);
    faces.areas.push_back(twice / 2);
  }
  join(faces);
  return faces;
}

std::vector<FaceGroup> connected(const Faces& faces, const FaceGroup& among, double least) {
  std::vector<bool> open(faces.triangles.size(), false);
  for (const std::uint32_t t : among) open[t] = true;
  std::vector<FaceGroup> out;
  for (const std::uint32_t seed : among) {
    if (!open[seed]) continue;
    FaceGroup group{seed};
    open[seed] = false;
    for (std::size_t i = 0; i < group.size(); ++i)
      for (const std::uint32_t n : faces.neighbours[group[i]])
        if (n != kNoNeighbour && open[n] &&
            glm::dot(faces.normals[group[i]], faces.normals[n]) >= least) {
          open[n] = false;
          group.push_back(n);
        }
    std::sort(group.begin(), group.end());
    out.push_back(std::move(group));
  }
  return out;
}

std::vector<FaceGroup> flat_parts(const Faces& faces, const FaceGroup& group, double share,
                                  double tolerance) {
  std::vector<bool> open(faces.triangles.size(), false);
  for (const std::uint32_t t : group) open[t] = true;
  FaceGroup seeds = group;
  std::stable_sort(seeds.begin(), seeds.end(), [&](std::uint32_t a, std::uint32_t b) {
    return faces.areas[a] > faces.areas[b];
  });
  const double all = area_of(faces, group);
  std::vector<FaceGroup> out;
  for (const std::uint32_t seed : seeds) {
    if (!open[seed]) continue;
    const Vec3 normal = faces.normals[seed], origin = faces.points[faces.triangles[seed][0]];
    const auto lies = [&](std::uint32_t t) {
      if (glm::dot(faces.normals[t], normal) < 0.99996) return false;  // half a degree
      return std::ranges::all_of(faces.triangles[t], [&](std::uint32_t v) {
        return std::fabs(glm::dot(faces.points[v] - origin, normal)) <= tolerance;
      });
    };
    FaceGroup part{seed};
    open[seed] = false;
    for (std::size_t i = 0; i < part.size(); ++i)
      for (const std::uint32_t n : faces.neighbours[part[i]])
        if (n != kNoNeighbour && open[n] && lies(n)) {
          open[n] = false;
          part.push_back(n);
        }
    if (area_of(faces, part) < share * all) continue;
    std::sort(part.begin(), part.end());
    out.push_back(std::move(part));
  }
  return out;
}

double area_of(const Faces& faces, const FaceGroup& group) {
  double sum = 0;
  for (const std::uint32_t t : group) sum += faces.areas[t];
  return sum;
}

double diagonal_of(const Faces& faces, const FaceGroup& group) {
  Vec3 low = faces.points[faces.triangles[group[0]][0]], high = low;
  for (const std::uint32_t t : group)
    for (const std::uint32_t v : faces.triangles[t]) {
      low = glm::min(low, faces.points[v]);
      high = glm::max(high, faces.points[v]);
    }
  return glm::length(high - low);
}

}  // namespace panwright::geometry
