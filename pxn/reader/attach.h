// Imported trees below nodes of a scene.
#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pxn/reader/cell_grid.h"
#include "pxn/reader/imported_model.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Shapes of the scene without their vertex colours, by those that have them.
using PlainShapes = std::map<std::int32_t, std::int32_t>;

// What attaching makes of shapes, for all places of a scene.
struct AttachedShapes {
  PlainShapes plain;
  CellGrids cells;
  // instances of the scene that are to wear foil, with those of the file: of the last attach()
  std::vector<std::pair<std::int32_t, std::uint32_t>> foiled;
  // of the last attach(): nodes of the scene that stand for PartImport::moved, by index, one for
  // each node that moves; and those whose axes no node can have, as they are sheared
  std::vector<std::pair<std::size_t, std::int32_t>> moving;
  std::vector<std::size_t> sheared;
  // of the last attach(): those of the file, on nodes of the scene
  std::vector<scene::Frame> frames;
};

// Materials of the scene for each instance of a file: of its front, and of its back, or kNone.
struct AttachedSides {
  std::span<const std::int32_t> materials;
  std::span<const std::int32_t> backs;
};

// Appends what a CAD file holds below a node, without what is removed: nodes that hold nothing any
// more stay out. What is assigned a material loses the colours of its vertices with its texture.
//
// Cells are laid out over faces as CellGrids does.
//
//   sides             what each instance wears, in the scene
//   world_from_below  of the node
//   prefix            of the names of the file's joints and frames
//   shapes            grows
void attach(const ImportedModel& model, const PartImport& place, const AttachedSides& sides,
            std::int32_t below, const Mat4& world_from_below, const std::string& prefix,
            AttachedShapes& shapes, scene::Scene& scene);

}  // namespace panwright::pxn
