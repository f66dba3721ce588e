// The materials of a file and of the library, for those who look at materials by themselves.
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

// Where a material's numbers come from, in its author's words; each may be empty.
struct Provenance {
  std::string source;                 // who published what the numbers follow
  std::string published;              // what is taken as published
  std::string fitted;                 // what was fitted, and to what
  std::string indicative;             // what is a plausible guess
  std::optional<double> absorptance;  // published solar absorptance

  // what the material names of materials/spectra.h
  std::string metal;
  std::string film;           // of the coat
  double film_thickness = 0;  // metres
};

struct DescribedMaterial {
  materials::Material material;  // with its name
  Provenance provenance;
  // of its file, which its maps are numbers of; null: it has none
  std::shared_ptr<const std::vector<scene::Texture>> textures;
  std::string back;  // the material of its back; empty: as it is itself
};

// The names of the library's materials, in alphabetical order.
std::vector<std::string_view> preset_names();

// The text that defines one, as a pxn file; nothing for another name.
std::optional<std::string_view> preset_text(std::string_view name);

// A material of the library.
//
// Fails: E1311, with the nearest name.
Result<DescribedMaterial> preset(std::string_view name, DiagnosticLog& log);

// Every named material of a file and of what it includes, whether something wears it or not, by
// name.
//
// Fails: as read().
Result<std::vector<DescribedMaterial>> read_materials(const std::filesystem::path& path,
                                                      const Options& options, DiagnosticLog& log,
                                                      const Job& job = {});

}  // namespace panwright::pxn
