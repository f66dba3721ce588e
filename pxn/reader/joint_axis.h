// Axes that faces of an import's nodes lie about, for its joints.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh/revolution_axes.h"

namespace panwright::pxn {

// A line, and the largest surface of revolution about it.
struct AxisLine {
  geometry::RevolvedFaces faces;  // metres, in the import's axes; the area of all that share it
  std::string node;               // of the largest one: its path in the import
  double share = 0;               // of the area of all faces
};

// What a joint says of its line by itself, in the import's axes.
struct WrittenLine {
  std::optional<Vec3> axis;    // unit
  std::optional<Vec3> origin;  // metres
};

// Those of some lines that a joint may mean, the first one best: what has faces rather than holes,
// within 5 degrees of a written axis, and through a written origin where any is (within their
// radius). Expects: largest area first.
std::vector<AxisLine> lines_meant(std::vector<AxisLine> lines, const WrittenLine& written);

// Whether the second of several is as good as the first: half its area, and another direction, or
// another place where that counts.
bool ambiguous(const std::vector<AxisLine>& lines, const WrittenLine& written);

// "origin=\"1m 0m 0m\" axis=\"0 0 1\"", with nine digits.
std::string as_attributes(const AxisLine& line);

}  // namespace panwright::pxn
