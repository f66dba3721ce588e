// Visible surfaces of a world on the image plane, by leaf.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/axis_box.h"
#include "base/job.h"
#include "labels/internal/image_plane.h"
#include "labels/parts.h"
#include "trace/scene.h"

namespace panwright::labels {

// Part of a target as it is placed.
struct DrawnPart {
  std::uint32_t target = 0;
  std::uint32_t part = 0;  // of its trace::Model
  std::uint32_t leaf = 0;
  trace::Affine camera_from_mesh;
};

// Some triangles of a part.
struct SurfacePiece {
  std::uint32_t drawn = 0;
  PlacedTriangles placed;
  // Smallest and largest y of each group of kGroup triangles, pixels.
  static constexpr std::size_t kGroup = 32;
  std::vector<std::pair<double, double>> rows;
};

struct Surfaces {
  std::vector<DrawnPart> drawn;
  std::vector<SurfacePiece> pieces;
  std::vector<std::vector<std::uint32_t>> of_leaf;  // pieces of each leaf
  std::vector<AxisRectangle> boxes;                 // of each leaf
  std::vector<char> cut;                            // of each leaf: see PlacedTriangles::cut
  // Of each leaf: the target whose terrain it has. Its box is one about it.
  std::vector<std::optional<std::uint32_t>> ground;
};

// Expects: the observer of the scene is the camera. Throws Cancelled.
Surfaces placed_surfaces(const trace::Scene& scene, const ImagePlane& plane, const Things& things,
                         const Job& job);

// Replaces the boxes of leaves by those of what lies between two heights, pixels.
void cut_boxes(Surfaces& surfaces, double top, double bottom);

}  // namespace panwright::labels
