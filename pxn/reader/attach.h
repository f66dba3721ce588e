// Attachment of imported trees below nodes of a scene.
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

// Shapes of the scene without their vertex colours, by the shapes with them.
using PlainShapes = std::map<std::int32_t, std::int32_t>;

// Shapes made by attaching, for all places of a scene.
struct AttachedShapes {
  PlainShapes plain;
  CellGrids cells;
  // of the last attach(): instances of the scene with foil, with those of the file
  std::vector<std::pair<std::int32_t, std::uint32_t>> foiled;
  // of the last attach(): nodes of the scene for PartImport::moved, by index, one for each moving
  // node; and those with sheared axes, which no node can have
  std::vector<std::pair<std::size_t, std::int32_t>> moving;
  std::vector<std::size_t> sheared;
  // of the last attach(): the file's frames, on nodes of the scene
  std::vector<scene::Frame> frames;
};

// Materials of the scene for each instance of a file: of its front, and of its back, or kNone.
struct AttachedSides {
  std::span<const std::int32_t> materials;
  std::span<const std::int32_t> backs;
};

// Attaches a CAD file's contents below a node, without removed instances and empty nodes. Instances
// with an assigned material lose their vertex colours and texture.
//
// Cells are laid out over faces by CellGrids.
//
//   sides             materials of each instance, in the scene
//   world_from_below  of the node
//   prefix            of the file's joint and frame names
//   shapes            grows
void attach(const ImportedModel& model, const PartImport& place, const AttachedSides& sides,
            std::int32_t below, const Mat4& world_from_below, const std::string& prefix,
            AttachedShapes& shapes, scene::Scene& scene);

}  // namespace panwright::pxn
