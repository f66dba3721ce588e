// Materials of robot descriptions.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "importers/internal/mesh_parts.h"

namespace panwright::importers {

struct Paint {
  std::string name;
  std::optional<std::array<double, 4>> rgba;
  std::string texture;                 // as written; empty: none
  std::vector<std::string> including;  // FileName::including; none: the model
  SourceSpan where;
  SourceSpan texture_at;
  bool has_content() const { return rgba || !texture.empty(); }
};

// Painter: makes each paint a material of the scene on first use.
class Painter {
 public:
  // The paints outlive this.
  Painter(const std::vector<Paint>& paints, meshes::ReaderContext& context,
          meshes::Assembly& assembly)
      : paints_(paints), c_(context), assembly_(assembly) {}

  // Returns the cover of a paint's index; none for −1. Reports W6004, W6005, W6008.
  Cover cover_of(std::int32_t paint);

  // Returns true for an opacity of 0. Expects: a paint's index.
  bool is_invisible(std::int32_t paint) const {
    const auto& rgba = paints_[static_cast<std::size_t>(paint)].rgba;
    return rgba && (*rgba)[3] <= 0;
  }

 private:
  const std::vector<Paint>& paints_;
  meshes::ReaderContext& c_;
  meshes::Assembly& assembly_;
  std::unordered_map<std::int32_t, Cover> covers_;
};

}  // namespace panwright::importers
