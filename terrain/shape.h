// Shape models of small bodies: plates of .tab, .plt, OBJ and ICQ files, and of SPICE DSK of
// type 2.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "base/result.h"
#include "terrain/map.h"

namespace panwright::terrain {

struct ShapeOptions {
  std::optional<double> unit;        // metres of a number; none: of the format or its label
  std::uint64_t bytes = 4ull << 30;  // of a file, at most
};

// Plates in body-fixed axes.
struct Shape {
  std::string format;  // "plates (.tab)", "plates (.plt)", "OBJ", "ICQ", "DSK type 2"
  std::string unit;    // of the file: "m" or "km"
  bool unit_stated = false;
  std::string body, frame;                           // of a DSK: NAIF ids; may be empty
  std::vector<Vec3> vertices;                        // metres
  std::vector<std::array<std::uint32_t, 3>> plates;  // counter-clockwise from outside
};

// Returns whether a file is a shape model, by its first bytes (of OBJ and ICQ by its first lines).
bool is_shape(const std::filesystem::path& path);

// Reads a shape model. Shared points of the faces of an ICQ file are one vertex.
//
// Fails: E0101, E9606 (damaged, with the line), E9602 (its unit is in doubt). Reports N9604, W9603.
Result<Shape> read_shape(const std::filesystem::path& path, const ShapeOptions& options,
                         DiagnosticLog& log);

struct ShapeExtreme {
  double radius = 0;  // metres from the origin
  LatLon place;
};

struct ShapeSurvey {
  ShapeExtreme least, largest;    // of vertices
  Vec3 low{0}, high{0};           // bounds, metres
  double area = 0;                // m²
  double volume = 0;              // m³, signed: negative where plates face inwards
  Vec3 centroid{0};               // of the volume, metres
  std::uint64_t open_edges = 0;   // of one plate, or of more than two
  std::uint64_t flat_plates = 0;  // without an area
};
ShapeSurvey survey_shape(const Shape& shape);

// Three views beside each other, along −x, −y and −z, each `side` pixels wide and high, lit from
// the upper left; 3·(3·side)·side bytes.
std::vector<std::uint8_t> draw_shape(const Shape& shape, std::uint32_t side);

}  // namespace panwright::terrain
