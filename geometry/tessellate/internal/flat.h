// Shared by boxes, extrusions and polygons.
#pragma once

#include <span>
#include <string>

#include "geometry/tessellate/internal/outline.h"
#include "geometry/tessellate/internal/tessellators.h"

namespace panwright::geometry::internal {

// Whether a mesh of so many triangles and vertices may be made. Fails: E2003.
bool within_counts(double triangles, double vertices, std::string_view what,
                   const TessellationOptions& options, SourceSpan where, DiagnosticLog& log);

// The first coordinate that single precision cannot hold: E2010, with the item's index.
Problem coordinate_problem(std::span<const Vec2> points, std::string_view part);
Problem coordinate_problem(std::span<const Vec3> points, std::string_view part);

// A region's fault in words. Edges count from 1 in their loop, holes too.
std::string sentence_of(const RegionFault& fault, const Region& region);
Code code_of(const RegionFault& fault, const Region& region);

// Right and up of a face seen from outside: +z is up, and +y where the face lies flat.
struct Upright {
  Vec3 right;
  Vec3 up;
};
Upright upright(const Vec3& normal);

}  // namespace panwright::geometry::internal
