// CAD files in a model.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "importers/import.h"

namespace panwright::pxn {

// CAD file, read once for each set of import options; its shapes and textures are in the scene.
struct ImportedModel {
  // root of names and paths: the file's root, or the node with its unit and axes
  std::uint32_t top = 0;
  importers::Imported imported;
  std::vector<std::string> material_names;  // numbered_names()
  std::vector<std::int32_t> shapes;         // in the scene, of each of the file's
  std::vector<std::int32_t> textures;       // in the scene, of each of the file's
};

// Returns the texture of an instance's base colour, in the file's scene: of paint, of a metal, or
// the palette of its one colour. −1: none.
std::int32_t base_texture(const importers::Imported& imported, const scene::Instance& instance);

// One place of an import, and the results of its rules.
struct PartImport {
  std::uint32_t model = 0;    // index into Loader::models
  std::vector<char> removed;  // of each of the file's instances
  std::vector<std::int32_t>
      materials;                    // of each instance, index into Loader::materials; −1: its own
  std::vector<char> keeps_texture;  // of each instance
  // Of each instance: the preset of its blanket (mli::presets()), empty for none, and its rule.
  struct Foil {
    std::string_view preset;
    std::uint32_t rule = 0;
  };
  std::vector<Foil> foils;
  bool keep_hidden = false;
  // Nodes that move together, and their joint.
  struct Moved {
    std::vector<std::uint32_t> nodes;  // of the file, none below another, ascending
    std::uint32_t joint = 0;           // index into Part::joints
    std::optional<Vec3> origin;        // in the import's coordinates; none: of the first node
    std::uint32_t rule = 0;            // the element
  };
  std::vector<Moved> moved;
};

}  // namespace panwright::pxn
