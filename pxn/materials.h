// Materials of a file and of the library.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "materials/material.h"
#include "pxn/pxn.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Provenance of a material's numbers, in its author's words; each may be empty.
struct Provenance {
  std::string source;                 // publication of the numbers
  std::string published;              // numbers taken as published
  std::string fitted;                 // fitted numbers, and their data
  std::string indicative;             // plausible guesses
  std::optional<double> absorptance;  // published solar absorptance

  // name in materials/spectra.h
  std::string metal;
  std::string film;           // of the coat
  double film_thickness = 0;  // metres
};

struct DescribedMaterial {
  materials::Material material;  // with its name
  Provenance provenance;
  // of its file, indexed by its maps; null: none
  std::shared_ptr<const std::vector<scene::Texture>> textures;
  std::string back;  // material of the back; empty: both sides are alike
};

// Returns the names of the library's materials, in alphabetical order.
std::vector<std::string_view> preset_names();

// Returns the text of a library material, as a pxn file; nothing for another name.
std::optional<std::string_view> preset_text(std::string_view name);

// Returns a material of the library.
//
// Fails: E1311, with the nearest name.
Result<DescribedMaterial> preset(std::string_view name, DiagnosticLog& log);

// Reads every named material of a file and of its includes, used or not, by name.
//
// Fails: as read().
Result<std::vector<DescribedMaterial>> read_materials(const std::filesystem::path& path,
                                                      const Options& options, DiagnosticLog& log,
                                                      const Job& job = {});

}  // namespace panwright::pxn
