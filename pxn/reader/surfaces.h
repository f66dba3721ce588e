// Materials of a scene, made from nodes, shapes and rules.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pxn/reader/loader.h"

namespace panwright::pxn {

// Surface of the shapes at a place of a model.
struct Surface {
  materials::Fields fields;
  std::string name;   // of the named material, if unchanged
  BackMaterial back;  // of that material
  SourceSpan place;   // the innermost appearance, for diagnostics about its material
};

// Materials, made once for each name and value. Numbered in the order of requests.
class Surfaces {
 public:
  Surfaces(const Loader& loader, const Options& options, Reporter& reporter, scene::Scene& scene)
      : loader_(loader), options_(options), reporter_(reporter), scene_(scene) {}

  // Returns a named material, by its index in the loader.
  Surface named(std::int32_t index) const;

  // Returns an index into the scene's materials.
  std::int32_t material(const Surface& surface);
  std::int32_t named_material(std::int32_t index) { return material(named(index)); }
  // Returns a library material. Expects: a known name.
  static Surface library(std::string_view name);
  // Returns the usual material of a foil preset.
  std::int32_t usual_material(std::string_view foil_preset);
  // Returns a material of a CAD file, once for each file.
  std::int32_t cad_material(std::uint32_t model_index, const ImportedModel& model,
                            std::int32_t index);

  // Returns the material of a back, for a front of the scene, with the front's holes unless it has
  // its own. kNone if none is named, if the shape is closed without holes, or if the two have
  // different holes: W1410 at `where()`, once for each pair.
  //
  //   shape  null: an open one
  std::int32_t back_of(const geometry::Shape* shape, std::int32_t front, const BackMaterial& back,
                       const std::function<SourceSpan()>& where);

 private:
  const Loader& loader_;
  const Options& options_;
  Reporter& reporter_;
  scene::Scene& scene_;
  std::uint32_t unnamed_ = 0;
  std::map<std::pair<std::string, std::vector<double>>, std::int32_t> by_fields_;
  std::map<std::pair<std::string, std::vector<double>>, std::int32_t> by_value_;
  std::map<std::pair<std::uint32_t, std::int32_t>, std::int32_t> cad_materials_;
  std::set<std::pair<std::int32_t, std::int32_t>> unlike_;  // fronts and backs, reported once
};

}  // namespace panwright::pxn
