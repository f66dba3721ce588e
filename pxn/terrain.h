// Terrain of a pxn file: which elevation files it is made of, and how. Plain data.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "materials/material.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Elevation file, and what is taken of it.
struct DemText {
  std::string file;  // relative to the top file's folder, '/' between parts
  scene::Source source;
  // answers to what the file leaves in doubt
  std::optional<double> unit;       // metres of a number
  std::optional<bool> radii;        // numbers are radii; false: heights
  std::optional<double> radius;     // metres, of the sphere
  std::optional<double> spacing;    // metres of a pixel
  std::optional<double> no_height;  // a number that stands for none, as stored
  // first column and row, columns and rows
  std::optional<std::array<std::uint32_t, 4>> pixels;
  std::optional<std::array<double, 4>> bounds;  // south, west, north, east
  std::uint32_t reduce = 1;
  double raise = 0;  // metres
  double blend = 0;  // metres
};

// Map of albedos.
struct AlbedoText {
  std::string file;  // as DemText::file
  scene::Source source;
  std::array<std::uint32_t, 3> bands{1, 1, 1};  // from 1; equal: grey
  double scale = 1;                             // of its numbers
  // radians: incidence, emission and phase of radiance factors; none: numbers are relative
  std::optional<std::array<double, 3>> reflectance;
  std::optional<double> radius, spacing;  // metres
  std::optional<double> no_value;         // a number that stands for none, as stored
};

struct TerrainText {
  double error = 0;                             // metres; 0: floats
  std::vector<DemText> dems;                    // the first that has a height counts
  std::vector<AlbedoText> albedo;               // the first that has a value counts
  std::optional<materials::Material> material;  // none: lunar regolith
  scene::Source source;
};

}  // namespace panwright::pxn
