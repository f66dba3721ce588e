// What is drawn, in which order, and where it stands for one view. Private to preview; nothing here
// needs OpenGL.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "materials/material.h"
#include "pan/model.h"
#include "preview/image.h"
#include "preview/internal/projection.h"
#include "preview/view.h"

namespace panwright::preview {

// The families of materials that each shading program serves, and which a material belongs to.
struct Families {
  std::array<std::vector<materials::Laws>, materials::kMostVariants> of_variant;
  std::vector<std::uint32_t> of_material;  // into its variant's, one for each material
};
Families families_of(const pan::Model& model);

// Which shader draws an instance, but for RenderOptions::flat.
struct Variant {
  std::uint32_t shading = 0;  // variant of the material
  bool textured = false;
  bool coloured = false;
  bool albedo_map = false;
  bool normal_map = false;
  bool roughness_map = false;
  bool reflectance_map = false;  // of a material with mirror facets
  bool cutout = false;
  bool cells = false;
  bool brushed = false;   // its light depends on the direction along u
  bool tangents = false;  // of each vertex: a normal map, or brushed with texture coordinates
  auto operator<=>(const Variant&) const = default;
};

// One instance of the model.
struct DrawItem {
  Variant variant;
  bool closed = false;    // its back faces are not drawn: closed, and without holes to see them
  bool mirrored = false;  // triangles are clockwise from outside, once placed
  std::int32_t texture = -1;
  std::uint32_t material = 0;
  std::uint32_t mesh = 0;
  std::uint32_t instance = 0;
  Mat4 model_from_mesh{1};  // of float positions, the mesh's origin included
  // cofactor matrix with the sign of the determinant, largest entry 1: takes outward normals to
  // outward normals of any length
  Mat3 model_normal_from_mesh{1};
  Vec2 repeat{1};          // of the texture coordinates, for maps
  Vec3 diffuse{0};         // colour; of cells, times its weight
  materials::Cells cells;  // where the variant has them
  Vec3 low{0};             // bounds in the mesh's frame
  Vec3 high{0};
};

// All instances, sorted so that neighbours share as much state as possible: by variant, sides,
// texture, material, mesh, then as they stand in the model.
std::vector<DrawItem> draw_list(const pan::Model& model);

// The items that may be seen, placed.
struct Scenery {
  std::vector<std::uint32_t> items;  // into the draw list, ascending
  std::vector<PlacedBox> boxes;      // of these items
  DepthRange depth;
};
Scenery scenery(const View& view, std::span<const DrawItem> list);

// Where an item stands, for its triangles one by one.
struct Placement {
  Mat4 camera_from_mesh{1};
  Mat3 world_normal_from_mesh{1};
};
// One for each item of the list; those out of view are left as they are.
std::vector<Placement> placements(const View& view, const Scenery& scenery,
                                  std::span<const DrawItem> list);

// The triangles that an id buffer holds at the pixels' centres.
struct TriangleId {
  std::uint32_t item = 0;  // into the draw list, + 1; 0: background
  std::uint32_t triangle = 0;
};

// Fills the truth layers of a tile's pixels: each centre's ray is intersected, in double, with the
// triangle that the context found there. A ray that passes the triangle by, which happens within
// the context's sub-pixel grid, takes the point on the triangle's plane, or, where that lies
// further off than a pixel spans, the nearest point of the triangle.
//
//   ids    tile.width*tile.height, rows from the top
//   image  its truth layers hold background where nothing was written yet
void fill_truth(const pan::Model& model, const View& view, bool flat,
                std::span<const DrawItem> list, std::span<const Placement> placed, const Tile& tile,
                std::span<const TriangleId> ids, Image& image);

// The geometric unit normals of a mesh's triangles in its own frame, by cross products in double of
// the stored positions; 0 0 0 for triangles without area. 3*T
std::vector<float> triangle_normals(const pan::MeshView& mesh);

}  // namespace panwright::preview
