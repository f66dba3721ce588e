// Library of materials. Private to pxn.
#pragma once

#include <string_view>

#include "materials/material.h"
#include "pxn/materials.h"

namespace panwright::pxn {

// File of materials/presets, embedded at build time: one named material each, of the file's name.
struct PresetText {
  std::string_view name;
  std::string_view text;
};
extern const PresetText kPresetTexts[];  // by name
extern const std::size_t kPresetCount;

struct Preset {
  materials::Fields fields;
  Provenance provenance;
  std::string_view back;  // another one of the library; empty: none
};

// Returns a library material, read on first use and kept; nullptr for another name. Thread-safe.
const Preset* find_preset(std::string_view name);

}  // namespace panwright::pxn
