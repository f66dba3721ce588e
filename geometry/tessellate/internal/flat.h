// Functions shared by boxes, extrusions and polygons.
#pragma once

#include <span>
#include <string>

#include "geometry/tessellate/internal/outline.h"
#include "geometry/tessellate/internal/tessellators.h"

namespace panwright::geometry::internal {

// Returns true if a mesh of this size is allowed. Fails: E2003.
bool within_counts(double triangles, double vertices, std::string_view what,
                   const TessellationOptions& options, SourceSpan where, DiagnosticLog& log);

// Returns the first coordinate out of single precision's range: E2010, with the item's index.
Problem coordinate_problem(std::span<const Vec2> points, std::string_view part);
Problem coordinate_problem(std::span<const Vec3> points, std::string_view part);

// Describes a region's fault. Edges count from 1 in their loop, holes too.
std::string sentence_of(const RegionFault& fault, const Region& region);
Code code_of(const RegionFault& fault, const Region& region);

// Right and up of a face seen from outside: +z is up, and +y for horizontal faces.
struct Upright {
  Vec3 right;
  Vec3 up;
};
Upright upright(const Vec3& normal);

}  // namespace panwright::geometry::internal
