#include "materials/cells.h"

#include <cmath>

#include "materials/internal/formula_texts.h"
#include "materials/internal/formulas.h"

namespace panwright::materials {

CellShares cells_at(const Cells& cells, const Vec2& texcoord, const Vec2& footprint) {
  const Vec2 at = texcoord * cells.count;
  const Vec2 size = footprint * cells.count;
  const Vec3 shares = f64::cell_shares(at.x, at.y, size.x, size.y, cells.gap.x, cells.gap.y,
                                       std::floor(cells.fingers + 0.5), cells.finger_width);
  return {shares.x, shares.y, shares.z};
}

std::array<Material, 3> cell_parts(const Material& material) {
  Material cell = material;
  cell.cells = {};
  Material finger = cell;
  finger.weights = {1, 0, material.weights.z};
  finger.diffuse_brdf = Lambert{};
  finger.specular_brdf = NoSpecular{};
  Material gap = finger;
  gap.coat = {};
  gap.weights.z = 0;
  if (material.cells) {
    finger.diffuse = material.cells->finger_color;
    gap.diffuse = material.cells->gap_color;
    // the cells' mean plane is that of their slopes
    cell.cells = Cells{.gap = Vec2(0), .fingers = 0, .tilt = material.cells->tilt};
  }
  for (Material* part : {&cell, &finger, &gap}) fit(*part);
  return {cell, finger, gap};
}

std::string glsl_cells() {
  return std::string("#define Real float\n#define Vec3 vec3\n#define FORMULA\n") + cells_text +
         "#undef Real\n#undef Vec3\n#undef FORMULA\n";
}

}  // namespace panwright::materials
