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
  SourceSpan where;                                 // name, in the library
  std::optional<Vec3> diffuse, specular, emissive;  // Kd, Ks, Ke
  std::optional<double> shine;                      // Ns
  std::optional<double> opacity;                    // d; after reading, by Tr
  std::optional<double> transparency;               // Tr as written
  std::optional<double> roughness, metallic;        // Pr, Pm
  std::optional<double> index;                      // Ni
  std::optional<int> model;                         // illum
  MtlTexture albedo, normal;                        // map_Kd, norm
  std::vector<LostProperty> lost;
};

// Material libraries of an OBJ file.
class MtlLibraries {
 public:
  MtlLibraries(ReaderContext& context, Assembly& assembly) : s_(context), assembly_(assembly) {}

  // Reads the libraries of a line "mtllib": one file whose name may hold blanks, or several.
  void read(std::string_view names, SourceSpan where);

  // Returns the number of a name, whose library may come later.
  std::int32_t number_of(std::string_view name, SourceSpan where);

  // Resolves the names, once all libraries are read; an unknown one gets a material of its own,
  // with W6502.
  void resolve_names();

  // Returns the scene's material for a number of a resolved name; −1: for none.
  //
  //   coloured   the vertices have colours
  //   texcoords  textures can be mapped
  std::int32_t scene_material(std::int32_t number, bool colored, bool texcoords);

 private:
  void read_library(std::string_view name, SourceSpan where);
  FileName library_name(std::string_view name) const;
  void add_library(const NamedFile& found, SourceSpan where);
  void read_text(const std::string& path, const SharedText& bytes, SourceSpan where);

  ReaderContext& s_;
  Assembly& assembly_;
  std::vector<MtlMaterial> materials_;
  struct Use {
    std::string name;
    SourceSpan where;  // of its first use
    std::int32_t material = -1;
  };
  std::vector<Use> uses_;                                     // by number
  std::map<std::string, std::int32_t, std::less<>> numbers_;  // of names in use
  std::map<std::string, std::int32_t, std::less<>> by_name_;  // materials of the libraries
  std::set<std::string, std::less<>> lines_;                  // after "mtllib", already read
  std::set<std::string, std::less<>> asked_;                  // names of libraries
  std::set<std::string> libraries_;                           // paths of those read
  std::map<std::pair<std::int32_t, bool>, std::int32_t> made_;
  bool any_missing_ = false;  // a library: unknown names are then expected
};

}  // namespace panwright::importers::meshes
