// Our materials as glTF's. Private to importers/gltf.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>

#include "materials/material.h"

namespace panwright::exporters {

// Whether a material's reflectance map can stand as the colour of a metal: one that shines and does
// nothing else.
bool is_coloured_metal(const materials::Material& material);

// What glTF's material keeps of ours, without textures. Of a coloured metal, the factor of its map.
//
//   lost        gets what it does not keep
//   extensions  gets the names of those that are used
nlohmann::ordered_json exported(const materials::Material& material, std::set<std::string>& lost,
                                std::set<std::string>& extensions);

}  // namespace panwright::exporters
