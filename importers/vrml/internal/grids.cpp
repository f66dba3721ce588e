// Height fields → faces.
#include <fmt/core.h>

#include "importers/vrml/internal/faces.h"

namespace panwright::importers::vrml {

namespace {

// Rows of points from one run of quadrilaterals to the next.
std::vector<std::int32_t> quad_index(std::int32_t columns, std::int32_t rows) {
  std::vector<std::int32_t> index;
  index.reserve(5 * static_cast<std::size_t>(columns - 1) * static_cast<std::size_t>(rows - 1));
  for (std::int32_t j = 0; j + 1 < rows; ++j) {
    for (std::int32_t i = 0; i + 1 < columns; ++i) {
      const std::int32_t at = j * columns + i;
      index.insert(index.end(), {at, at + columns, at + columns + 1, at + 1, -1});
    }
  }
  return index;
}

}  // namespace

geometry::Mesh mesh_of(const ElevationGrid& grid, const FaceOptions& options,
                       ListProblems& problems) {
  const std::int64_t columns = grid.x_dimension;
  std::int64_t rows = grid.z_dimension;
  if (columns < 2 || rows < 2) {
    problems.push_back({Code("W6114"), List::none, 0,
                        fmt::format("a grid of {} by {} heights has no surface", columns, rows)});
    return {};
  }
  const auto given = static_cast<std::int64_t>(grid.heights.size());
  if (given < columns * rows) {
    problems.push_back({Code("W6114"), List::heights, grid.heights.size(),
                        fmt::format("{} heights are given and {} are needed; whole rows are read",
                                    given, columns * rows)});
    rows = given / columns;
    if (rows < 2) return {};
  }
  const std::int64_t triangles = 2 * (columns - 1) * (rows - 1);
  if (static_cast<std::uint64_t>(triangles) > options.max_triangles) {
    problems.push_back({Code("E6002"), List::none, 0,
                        fmt::format("{} triangles are needed, and the limit is {}", triangles,
                                    options.max_triangles)});
    return {};
  }
  const auto size = static_cast<std::size_t>(columns * rows);
  std::vector<double> points(3 * size);
  std::vector<double> texcoords(grid.texcoords.empty() && options.texcoords ? 2 * size : 0);
  for (std::size_t at = 0, j = 0; j < static_cast<std::size_t>(rows); ++j) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(columns); ++i, ++at) {
      points[3 * at] = grid.x_spacing * static_cast<double>(i);
      points[3 * at + 1] = grid.heights[at];
      points[3 * at + 2] = grid.z_spacing * static_cast<double>(j);
      if (texcoords.empty()) continue;
      texcoords[2 * at] = static_cast<double>(i) / static_cast<double>(columns - 1);
      texcoords[2 * at + 1] = static_cast<double>(j) / static_cast<double>(grid.z_dimension - 1);
    }
  }
  std::vector<std::int32_t> index =
      quad_index(static_cast<std::int32_t>(columns), static_cast<std::int32_t>(rows));
  FaceSet faces;
  faces.points = points;
  faces.coord_index = index;
  faces.normals = grid.normals;
  faces.normal_per_vertex = grid.normal_per_vertex;
  faces.colors = grid.colors;
  faces.color_per_vertex = grid.color_per_vertex;
  faces.texcoords = grid.texcoords.empty() ? texcoords : grid.texcoords;
  faces.ccw = grid.ccw;
  faces.crease_angle = grid.crease_angle;
  FaceOptions own = options;
  own.served = [&](List list) {
    if (list == List::points) points = std::vector<double>();
    if (list == List::coord_index) index = std::vector<std::int32_t>();
  };
  geometry::Mesh mesh = mesh_of(faces, own, problems);
  for (ListProblem& problem : problems)
    if (problem.list == List::points) problem.list = List::heights;  // one for each point
  return mesh;
}

}  // namespace panwright::importers::vrml
