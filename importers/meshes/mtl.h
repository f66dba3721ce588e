// Material libraries of OBJ. Private to importers/meshes.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "importers/internal/reader_context.h"

namespace panwright::importers::meshes {

// Texture named by a material.
struct MtlTexture {
  std::string name;  // empty: none
  SourceSpan where;  // in the library
  Vec2 repeat{1};    // option -s
};

struct MtlMaterial {
  std::string name;
  std::string library;                              // path, as in Files
  std::optional<Vec3> diffuse, specular, emissive;  // Kd, Ks, Ke
  std::optional<double> shine;                      // Ns
  std::optional<double> opacity;                    // d; after reading, by Tr
  std::optional<double> transparency;               // Tr as written
  std::optional<double> roughness, metallic;        // Pr, Pm
  std::optional<double> index;                      // Ni
  std::optional<int> model;                         // illum
  MtlTexture albedo, normal;                        // map_Kd, norm
  std::vector<std::string> lost;
};

// Material libraries of an OBJ file.
class MtlLibraries {
 public:
  MtlLibraries(ReaderContext& context, Assembly& assembly) : s_(context), assembly_(assembly) {}

  // Reads the libraries of a line "mtllib": one file whose name may hold blanks, or several.
  void read(std::string_view names, SourceSpan where);

  // Returns the number of a name; an unknown one gets a material of its own, with W6502.
  std::int32_t number_of(std::string_view name, SourceSpan where);

  // Returns the scene's material for a number; −1: for none.
  //
  //   coloured   the vertices have colours
  //   texcoords  textures can be mapped
  std::int32_t scene_material(std::int32_t number, bool colored, bool texcoords);

 private:
  void read_library(std::string_view name, SourceSpan where);
  void read_text(const std::string& path, const SharedText& bytes, SourceSpan where);

  ReaderContext& s_;
  Assembly& assembly_;
  std::vector<MtlMaterial> materials_;
  std::map<std::string, std::int32_t, std::less<>> numbers_;
  std::set<std::string, std::less<>> lines_;      // after "mtllib", already read
  std::set<std::string, std::less<>> libraries_;  // asked for
  std::map<std::pair<std::int32_t, bool>, std::int32_t> made_;
  std::size_t unknown_ = 0;
  bool any_missing_ = false;  // a library: unknown names are then expected
};

}  // namespace panwright::importers::meshes
