// Axes of faces of an import's nodes, for its joints.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh/revolution_axes.h"

namespace panwright::pxn {

// Line, and the largest surface of revolution about it.
struct AxisLine {
  geometry::RevolvedFaces faces;  // metres, in the import's axes; the area of all on this axis
  std::string node;               // of the largest one: its path in the import
  double share = 0;               // of the area of all faces
};

// Line given by a joint itself, in the import's axes.
struct WrittenLine {
  std::optional<Vec3> axis;    // unit
  std::optional<Vec3> origin;  // metres
};

// Returns the lines that a joint may mean, the best first: with faces rather than holes, within 5
// degrees of a given axis, and through a given origin if any is (within their radius). Expects:
// largest area first.
std::vector<AxisLine> lines_meant(std::vector<AxisLine> lines, const WrittenLine& written);

// Returns true if the second line is as good as the first: half its area, and another direction, or
// another place if that matters.
bool ambiguous(const std::vector<AxisLine>& lines, const WrittenLine& written);

// Returns "origin=\"1m 0m 0m\" axis=\"0 0 1\"", with nine digits.
std::string as_attributes(const AxisLine& line);

}  // namespace panwright::pxn
