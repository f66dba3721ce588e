// Ground truth layers from an id buffer. Private to preview; nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "image/image.h"
#include "preview/frame/visible_set.h"
#include "preview/model/draw_list.h"

namespace panwright::preview {

// Placement of an item, for single triangles.
struct Placement {
  Mat4 camera_from_mesh{1};
  Mat3 world_normal_from_mesh{1};
};

// Target in the id buffer.
struct GroundTruthTarget {
  std::shared_ptr<const pan::Model> model;
  std::shared_ptr<const std::vector<DrawItem>> items;
  std::uint32_t target = 0;           // index in the world
  std::uint32_t first_id = 0;         // as in VisibleTarget
  std::vector<Placement> placements;  // one per item; stale for those out of view
};
// Sets all of one, reusing its memory.
void set_truth_target(GroundTruthTarget& target, std::shared_ptr<const pan::Model> model,
                      std::shared_ptr<const std::vector<DrawItem>> items,
                      const VisibleTarget& visible, const world::Pose& pose);

// Triangles of an id buffer at the pixels' centres.
struct TriangleId {
  std::uint32_t item = 0;  // its id; 0: background
  std::uint32_t triangle = 0;
};

// Fills the ground truth layers of a tile's pixels: each centre's ray is intersected, in double,
// with the context's triangle there. A ray may miss the triangle within the context's sub-pixel
// grid. It then takes the point on the triangle's plane, or, if that is over a pixel away, the
// nearest point of the triangle.
//
//   targets  ascending by first_id
//   ids      tile.width*tile.height, rows from the top
//   image    its ground truth layers are initialised to background
void fill_ground_truth(const world::Camera& camera, bool flat,
                       std::span<const GroundTruthTarget> targets, const Tile& tile,
                       std::span<const TriangleId> ids, image::Image& image);

}  // namespace panwright::preview
