// One pxn file, read: its nodes in order, with their values. A file that is included many times is
// one part.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "materials/material.h"
#include "pxn/internal/files.h"
#include "pxn/internal/xml.h"
#include "scene/scene.h"

namespace panwright::pxn {

enum class ItemKind : std::uint8_t {
  group,
  transform,   // data: index into transforms
  rotate,      // data: index into transforms
  appearance,  // data: index into fields
  texture,     // data: index into scene::Scene::textures
  sphere,      // data: index into scene::Scene::shapes
  mesh,        // data: index into scene::Scene::shapes
  frame,       // data: index into frames
  include,     // data: index of the included part
};

// Items stand in document order; those inside one follow it, up to `end`.
struct Item {
  ItemKind kind;
  std::uint32_t element;
  std::uint32_t end;  // item index, past the last one inside
  std::uint32_t data;
  std::uint32_t line;
  std::uint32_t column;
};

struct PartFrame {
  std::string label;
  Vec3 origin;
  Quat rotation;  // node_from_frame
};

struct Part {
  FoundFile file;
  xml::Document document;
  std::vector<Item> items;
  std::vector<scene::Transform> transforms;
  std::vector<materials::Fields> fields;
  std::vector<PartFrame> frames;
  std::uint32_t height = 0;          // elements on the longest path, through includes
  std::uint32_t include_height = 0;  // files on the longest path of includes below this one
  bool loading = true;               // its own includes are being read: including it is a cycle
};

}  // namespace panwright::pxn
