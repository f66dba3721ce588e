// Mesh files below nodes of a scene.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "importers/internal/reader_context.h"

namespace panwright::importers {

// Mesh named by a robot description.
struct MeshFile {
  std::string name;                    // as written
  std::vector<std::string> including;  // FileName::including; none: the model
  Vec3 scale{1};
  SourceSpan where;
};

// Material of a surface without its own.
struct Cover {
  std::int32_t material = scene::kNone;  // none: the mesh file's, or grey
  std::int32_t texture = scene::kNone;
};

class MeshParts {
 public:
  MeshParts(meshes::ReaderContext& context, meshes::Assembly& assembly)
      : c_(context), assembly_(assembly) {}

  // Attaches the contents of a file below a node, in its axes; unit: the metre unless the file
  // gives another. A file is read once. Reports E6010 for a missing file, W6221 if it has materials
  // of its own or no texture coordinates.
  void attach(const MeshFile& mesh, std::int32_t node, const Cover& cover);

  // Returns the read files, in order of first use.
  std::vector<scene::Input> take_inputs() { return std::move(inputs_); }

 private:
  struct Part {
    std::vector<scene::Node> nodes;
    std::vector<scene::Instance> instances;  // shapes, materials, textures: of the whole scene
    std::vector<scene::Joint> joints;
    std::vector<char> bare;       // of each instance: the file gives no material
    std::vector<char> texcoords;  // of each instance
  };

  const Part* part(const MeshFile& mesh);
  Part taken(Imported& imported);

  meshes::ReaderContext& c_;
  meshes::Assembly& assembly_;
  std::map<std::string, std::optional<Part>> by_name_;  // and folders
  std::map<std::string, std::string> first_name_;       // of each path
  std::set<std::string> known_inputs_;
  std::vector<scene::Input> inputs_;
  std::uint64_t triangles_ = 0;
  std::uint64_t texture_bytes_ = 0;
};

}  // namespace panwright::importers
