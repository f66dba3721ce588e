// Draw list of a model, in drawing order, and its placement for one view. Private to preview;
// nothing here needs OpenGL.
#pragma once

#include <array>
#include <cmath>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "image/image.h"
#include "materials/material.h"
#include "pan/model.h"
#include "preview/gl/uniforms.h"
#include "preview/gl/variant.h"
#include "world/evaluation.h"

namespace panwright::preview {

// BRDF models of a model. One program shades the materials of each.
struct Families {
  std::vector<materials::BrdfModel> all;   // sorted
  std::vector<std::uint32_t> of_material;  // into all, one per material
  std::vector<std::uint32_t> materials;    // number of materials of each
};
Families families_of(const pan::Model& model);

enum class Sides : std::uint8_t { both, front, back };

// One instance of the model, or one side of it.
struct DrawItem {
  Variant variant;
  // drawn faces: only the front's if closed and without holes; a surface whose back has another
  // material is drawn once for each
  Sides sides = Sides::both;
  bool mirrored = false;  // triangles are clockwise from outside, once placed
  std::int32_t texture = -1;
  std::uint32_t material = 0;
  std::uint32_t mesh = 0;
  std::uint32_t instance = 0;
  Mat4 model_from_mesh{1};  // of float positions, the mesh's origin included
  // cofactor matrix with the sign of the determinant, largest entry 1: maps outward normals to
  // outward normals of any length
  Mat3 model_normal_from_mesh{1};
  Vec2 repeat{1};          // of the texture coordinates, for maps
  Vec3 diffuse{0};         // colour; of cells, times its weight
  double lobe = 0;         // for curved variants: the squared slope of the narrowest lobe
  materials::Cells cells;  // for variants with cells
  Vec3 low{0};             // bounds in the mesh's frame
  Vec3 high{0};
  double rounding = 0;  // interpolation_error() of the mesh, metres in its frame
  bool shown = true;    // its node is
  // Levels of detail (pan::layout::Level): visible for pixel footprints from this to the next,
  // metres in the model's frame.
  double detail = 0;  // in the mesh's own coordinates, of the level and of the one after it
  double next_detail = HUGE_VAL;
  double from = 0;
  double to = HUGE_VAL;
  bool visible = true;  // shown, and of the chosen level

  void set_pixel(double metres) { visible = shown && from <= metres && metres < to; }
};

// Returns true if two items differ only in placement.
bool is_drawn_alike(const DrawItem& a, const DrawItem& b);

// Returns the number of neighbours of a list, from the first, for one draw: those of one mesh and
// material, up to the programs' limit; 1 if too few to pay for programs of their own.
//
//   item(i)  the i-th, a const DrawItem&
template <class Item>
std::size_t drawn_at_once(std::size_t first, std::size_t end, const Item& item) {
  constexpr std::size_t kLeast = 8;
  std::size_t last = first + 1;
  while (last < end && last - first < kInstancesAtOnce && is_drawn_alike(item(first), item(last)))
    ++last;
  return last - first < kLeast ? 1 : last - first;
}

// Returns all instances at all levels of detail, the finest visible. Sorted to share state between
// neighbours: by variant, sides, texture, material, mesh, then the model's order.
std::vector<DrawItem> draw_list(const pan::Model& model);

// Returns the list placed for a target of a world: same order, other transforms and visibilities;
// the finest levels are visible.
std::vector<DrawItem> placed(std::span<const DrawItem> list, const pan::Model& model,
                             const world::EvaluatedInstance& at);

// Returns what positions interpolated in single precision are off within triangles, metres: their
// length squared over their height, times a rounding. At most, of all but a hundredth of the mesh's
// area; a power of two.
double interpolation_error(const pan::MeshView& mesh);

// Returns the geometric unit normals of a mesh's triangles in its own frame, by cross products in
// double of the stored positions; 0 0 0 for triangles without area. 3*T
std::vector<float> triangle_normals(const pan::MeshView& mesh);

}  // namespace panwright::preview
