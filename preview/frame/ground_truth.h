// Truth layers from an id buffer. Private to preview; nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "preview/frame/draw_list.h"
#include "preview/frame/visible_set.h"
#include "preview/image.h"

namespace panwright::preview {

// Where an item stands, for its triangles one by one.
struct Placement {
  Mat4 camera_from_mesh{1};
  Mat3 world_normal_from_mesh{1};
};

// A target that the id buffer may name.
struct GroundTruthTarget {
  std::shared_ptr<const pan::Model> model;
  std::shared_ptr<const std::vector<DrawItem>> items;
  std::uint32_t target = 0;           // index in the world
  std::uint32_t first_id = 0;         // as VisibleTarget says
  std::vector<Placement> placements;  // one per item; those out of view are left as they are
};
// Sets all of one; its memory is used again.
void set_truth_target(GroundTruthTarget& target, std::shared_ptr<const pan::Model> model,
                      std::shared_ptr<const std::vector<DrawItem>> items,
                      const VisibleTarget& visible, const world::Pose& pose);

// The triangles that an id buffer holds at the pixels' centres.
struct TriangleId {
  std::uint32_t item = 0;  // its id; 0: background
  std::uint32_t triangle = 0;
};

// Fills the ground truth layers of a tile's pixels: each centre's ray is intersected, in double,
// with the triangle that the context found there. A ray that passes the triangle by, which happens
// within the context's sub-pixel grid, takes the point on the triangle's plane, or, where that lies
// further off than a pixel spans, the nearest point of the triangle.
//
//   targets  ascending by first_id
//   ids      tile.width*tile.height, rows from the top
//   image    its ground truth layers hold background where nothing was written yet
void fill_ground_truth(const world::Camera& camera, bool flat,
                       std::span<const GroundTruthTarget> targets, const Tile& tile,
                       std::span<const TriangleId> ids, Image& image);

}  // namespace panwright::preview
