// Relief finer than the triangles of terrain, as facets that stand for all of its slopes. Private
// to preview/reference.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "base/math.h"
#include "terrain/ground.h"

namespace panwright::preview::reference {

// Facets of a surface as a viewer sees them.
struct Facets {
  static constexpr std::size_t kMost = 7;
  std::size_t count = 0;
  std::array<Vec3, kMost> normals;    // unit
  std::array<double, kMost> weights;  // shares of the area that is seen; their sum is 1
};

// Facets of normally distributed slopes; nothing where none faces the viewer.
//
// Means over them are exact for polynomials of slopes up to the fifth degree, of slopes below 7
// degrees up to the second: A. H. Stroud, "Approximate calculation of multiple integrals", 1971,
// E2r2 5-1 and 2-1. Slopes below 0.8 degrees have one facet.
//
//   to_viewer  unit, body-fixed
std::optional<Facets> facets_of(const terrain::GroundRelief& relief, const Vec3& to_viewer);

}  // namespace panwright::preview::reference
