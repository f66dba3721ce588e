// Solar-cell grids on imported faces.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Layout of solar cells over imported faces: one unit of texture coordinates is one metre of the
// world there, so that columns and rows count per metre. Directions come from the file's texture
// coordinates, if geometry::flat_faces() finds them unsheared along the face's longest edge, else
// from the sides of rectangles. Other faces have the material without its cells. If a texture needs
// the file's coordinates, they stay unchanged, and rectangles have no cells either.
class CellGrids {
 public:
  explicit CellGrids(scene::Scene& scene) : scene_(scene) {}

  // Appends an imported instance to the scene; one with cells becomes up to two: the faces with
  // cells and those without. Shapes and materials are made once for all instances of a shape, a
  // scale and a material.
  void append(scene::Instance instance, const Mat4& world_from_node);

  // Reports one N2021 for all faces that got coordinates, one W6008 for all without cells.
  void report(SourceSpan where, DiagnosticLog& log) const;

 private:
  // Shape, presence of a texture, and the metric of its frame in the world.
  using Key = std::tuple<std::int32_t, bool, std::array<double, 6>>;
  struct Faces {
    std::size_t count = 0;
    double area = 0;  // m²
  };
  struct Laid {
    std::int32_t with_cells = scene::kNone;  // shapes
    std::int32_t without = scene::kNone;
    Faces file, rectangles, off;
  };

  const Laid& laid(std::int32_t shape, bool textured, const Mat4& world_from_node);
  Laid lay_out(std::int32_t shape, bool textured, const std::array<double, 6>& metric);
  std::int32_t without_cells(std::int32_t material);

  scene::Scene& scene_;
  std::map<Key, Laid> known_;
  std::map<std::int32_t, std::int32_t> plain_materials_;
  std::size_t triangles_ = 0;  // made so far
  Faces file_, rectangles_, off_;
  std::vector<std::string> off_nodes_;  // names, each once, in the order of instances
  std::set<std::string> off_names_;
};

}  // namespace panwright::pxn
