#include "labels/internal/surfaces.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "labels/internal/ground_bits.h"

namespace panwright::labels {

namespace {

constexpr std::size_t kVerticesAtOnce = 8192;
constexpr std::size_t kTrianglesAtOnce = 8192;
constexpr double kUnbounded = 1e12;  // pixels

// Vertices of a drawn part on the plane.
using PlacedPoints = std::vector<PlacedPoint>;

std::vector<PlacedPoints> placed_vertices(const trace::Scene& scene, const ImagePlane& plane,
                                          const std::vector<DrawnPart>& drawn, const Job& job) {
  struct Run {
    std::size_t drawn, begin, end;
  };
  std::vector<Run> runs;
  std::vector<PlacedPoints> result(drawn.size());
  const auto mesh_of = [&](const DrawnPart& part) -> const pan::MeshView& {
    return scene.targets()[part.target].target->model().parts()[part.part].mesh;
  };
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    const std::size_t count = mesh_of(drawn[k]).positions.size();
    result[k].resize(count);
    for (std::size_t begin = 0; begin < count; begin += kVerticesAtOnce)
      runs.push_back({k, begin, std::min(count, begin + kVerticesAtOnce)});
  }
  const auto place = [&](std::size_t r) {
    const Run& run = runs[r];
    const pan::MeshView& mesh = mesh_of(drawn[run.drawn]);
    const trace::Affine& camera_from_mesh = drawn[run.drawn].camera_from_mesh;
    for (std::size_t v = run.begin; v < run.end; ++v) {
      const auto& p = mesh.positions[v];
      result[run.drawn][v] = placed_point(plane, camera_from_mesh(Vec3(p.x, p.y, p.z)));
    }
  };
  parallel_for(runs.size(), place, job);
  return result;
}

// Triangles of a part that show from the camera: all of an open one.
void place_triangles(const trace::Model::Part& part, const ImagePlane& plane,
                     const PlacedPoints& points, double side, std::size_t begin, std::size_t end,
                     PlacedTriangles& out) {
  const bool one_sided = part.closed && (plane.central() || plane.orthographic());
  out.triangles.reserve(one_sided ? (end - begin) * 5 / 8 : end - begin);
  for (std::size_t t = begin; t < end; ++t) {
    const PlacedPoint& a = points[part.mesh.indices[3 * t]];
    const PlacedPoint& b = points[part.mesh.indices[3 * t + 1]];
    const PlacedPoint& c = points[part.mesh.indices[3 * t + 2]];
    if (one_sided) {
      const Vec3 normal = glm::cross(b.point - a.point, c.point - a.point);
      const double towards = plane.orthographic() ? -normal.z : -glm::dot(normal, a.point);
      if (!(towards * side > 0)) continue;
    }
    add_triangle(plane, a, b, c,
                 part.cutout >= 0 ? std::optional(static_cast<std::uint32_t>(t)) : std::nullopt,
                 out);
  }
}

void find_rows(SurfacePiece& piece) {
  const auto& triangles = piece.placed.triangles;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    if (k % SurfacePiece::kGroup == 0)
      piece.rows.emplace_back(std::numeric_limits<double>::infinity(),
                              -std::numeric_limits<double>::infinity());
    auto& [low, high] = piece.rows.back();
    for (const Vec2& p : triangles[k]) {
      low = std::min(low, p.y);
      high = std::max(high, p.y);
    }
  }
}

// Adds the part of an edge between two heights.
void add_between(const Vec2& a, const Vec2& b, double top, double bottom, AxisRectangle& box) {
  const auto at = [&](double y) { return a + (y - a.y) / (b.y - a.y) * (b - a); };
  const auto [low, high] = std::minmax(a.y, b.y);
  if (high < top || low > bottom) return;
  for (const Vec2& end : {a, b})
    if (end.y >= top && end.y <= bottom) box.add(end);
  for (const double y : {top, bottom})
    if (low < y && y < high) box.add(Vec2(at(y).x, y));
}

}  // namespace

void cut_boxes(Surfaces& surfaces, double top, double bottom) {
  for (std::size_t leaf = 0; leaf < surfaces.boxes.size(); ++leaf) {
    AxisRectangle& box = surfaces.boxes[leaf];
    if (box.empty() || (box.low.y >= top && box.high.y <= bottom)) continue;
    if (surfaces.ground[leaf]) {
      box.low.y = std::max(box.low.y, top);
      box.high.y = std::min(box.high.y, bottom);
      if (box.empty()) box = {};
      continue;
    }
    box = {};
    for (const std::uint32_t k : surfaces.of_leaf[leaf])
      for (const PlacedTriangle& triangle : surfaces.pieces[k].placed.triangles)
        for (std::size_t corner = 0; corner < 3; ++corner)
          add_between(triangle[corner], triangle[(corner + 1) % 3], top, bottom, box);
  }
}

Surfaces placed_surfaces(const trace::Scene& scene, const ImagePlane& plane, const Things& things,
                         const Job& job) {
  Surfaces result;
  for (const std::uint32_t t : scene.visible()) {
    const trace::Target& target = *scene.targets()[t].target;
    const trace::Affine camera_from_model = scene.observer_from(t);
    for (std::size_t k = 0; k < target.parts().size(); ++k) {
      const std::uint32_t part = target.parts()[k];
      result.drawn.push_back({t, part, things.leaf_of[t][target.model().parts()[part].node],
                              camera_from_model * target.placements()[k].model_from_mesh});
    }
  }
  const std::vector<PlacedPoints> points = placed_vertices(scene, plane, result.drawn, job);
  struct Run {
    std::size_t begin, end;
  };
  std::vector<Run> runs;
  for (std::uint32_t k = 0; k < result.drawn.size(); ++k) {
    const DrawnPart& drawn = result.drawn[k];
    const auto& part = scene.targets()[drawn.target].target->model().parts()[drawn.part];
    const std::size_t count = part.mesh.indices.size() / 3;
    for (std::size_t begin = 0; begin < count; begin += kTrianglesAtOnce) {
      runs.push_back({begin, std::min(count, begin + kTrianglesAtOnce)});
      result.pieces.emplace_back().drawn = k;
    }
  }
  const auto place = [&](std::size_t r) {
    SurfacePiece& piece = result.pieces[r];
    const DrawnPart& drawn = result.drawn[piece.drawn];
    const auto& part = scene.targets()[drawn.target].target->model().parts()[drawn.part];
    const double side = glm::determinant(drawn.camera_from_mesh.linear) < 0 ? -1 : 1;
    place_triangles(part, plane, points[piece.drawn], side, runs[r].begin, runs[r].end,
                    piece.placed);
    find_rows(piece);
  };
  parallel_for(runs.size(), place, job);
  const std::size_t leaves = things.of_leaf.size();
  result.of_leaf.resize(leaves);
  result.boxes.resize(leaves);
  result.cut.resize(leaves);
  for (std::uint32_t k = 0; k < result.pieces.size(); ++k) {
    const SurfacePiece& piece = result.pieces[k];
    const std::uint32_t leaf = result.drawn[piece.drawn].leaf;
    result.of_leaf[leaf].push_back(k);
    result.boxes[leaf].add(piece.placed.box);
    result.cut[leaf] |= static_cast<char>(piece.placed.cut);
  }
  result.ground.resize(leaves);
  for (const std::uint32_t t : scene.visible()) {
    if (scene.targets()[t].target->ground() == nullptr) continue;
    const std::uint32_t leaf = things.leaf_of[t][0];
    result.ground[leaf] = t;
    if (const auto box = ground_rectangle(scene, t, plane)) {
      result.boxes[leaf].add(*box);
      continue;
    }
    result.cut[leaf] = 1;
    result.boxes[leaf] = {Vec2(-kUnbounded), Vec2(kUnbounded)};
  }
  return result;
}

}  // namespace panwright::labels
