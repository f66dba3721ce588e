// Tolerance of meshes to their shapes: the only place that decides it.
#pragma once

#include <optional>

#include "base/math.h"
#include "geometry/tessellate/shape.h"
#include "materials/material.h"
#include "scene/scene.h"
#include "schemas/generated/pan_layout.h"

namespace panwright::compiler {

// The tolerance of a model without a budget: metres in the world, and the relative flux error of
// round shapes, which is what makes thin rods and small spheres finer.
inline constexpr double kDefaultTolerance = 1e-3;
inline constexpr double kDefaultFlux = 0.03;

// Relative flux error: a mesh within `error` of a shape of radius of curvature R is off by at most
// kFluxFactor·error/R. Holds for phase angles of 0 to 120 degrees and parts that keep at least a
// tenth of their full flux: thin crescents have larger relative errors.
//
// Derived: moving the lit limb of a Lambert cylinder outwards by the error changes the flux at
// phase a by 2·sin a/(sin a + (π − a)·cos a)·error/R: 1 at 64, 2 at 90, 5.06 at 120 degrees; of a
// sphere by 3·sin a/(…) times the mean of the limb, which averages out to less than half of the
// error. Worst measured with smooth normals (tests/compiler/tolerance_test.cpp), for an error of
// 0.03 R: cylinder 5.28, sphere 4.46; of 0.001 R: 5.09 and 3.40. At 90 degrees 2.1, at 150 over 20.
inline constexpr double kFluxFactor = 5.5;
// Photocentre error: at most kCentroidFactor·error, in metres. It is the limb's share of the flux,
// as above, times its distance from the photocentre, 0.67 at 90 degrees. Worst measured in the same
// way: sphere 1.60 for an error of 0.03 R, 0.75 of 0.001 R; cylinder 0.87.
inline constexpr double kCentroidFactor = 1.7;

// Largest distance of a mesh from its shape, in the world, and its reason.
struct Tolerance {
  double metres = kDefaultTolerance;
  pan::layout::ToleranceReason reason = pan::layout::ToleranceReason::tolerance;
};

// Inputs of a tolerance besides the model's budget and the shape.
struct ToleranceOverrides {
  std::optional<double> by_instance;      // metres in the world: overrides the budget
  std::optional<double> by_command_line;  // metres in the world: overrides everything
  // RMS slope of the narrowest microfacets of its materials (microfacet_slope).
  std::optional<double> slope = std::nullopt;
};

// Returns the tolerance of a shape: that of the command line, else the instance's, else the
// smallest of these terms of the budget:
//
//   tolerance   itself
//   pixels      pixels·ifov·nearest
//   centroid    centroid·ifov·nearest/kCentroidFactor
//   flux        flux·R/kFluxFactor, R the radius of curvature of the shape in the world; none for
//               flat shapes
//   slope       R·θ²/8, where normals between vertices θ apart are off by a quarter of the slope;
//               if the budget gives the pixel footprint, and no tolerance
//
// else kDefaultTolerance, or what kDefaultFlux asks where that is smaller; there R is the smallest
// radius of an ellipsoid, at least a 30th of its largest. Terms that lack a partner (pixels without
// ifov or nearest) give none. The reason of a shape with explicit counts, and of a mesh, is
// explicit_counts; the distance then holds for dimensions not fixed by counts.
//
//   world_from_shape   stretch of the shape into the world
Tolerance tolerance_for(const scene::Budget& budget, const geometry::Shape& shape,
                        const Stretch& world_from_shape, const ToleranceOverrides& asked);

// Converts a term of the budget to metres in the world: pixels and ifov radians at nearest metres.
double tolerance_of_pixels(double pixels, double ifov, double nearest);
double tolerance_of_centroid(double pixels, double ifov, double nearest);

// Returns the RMS slope of a material's narrowest microfacets, at least kLeastSlope, which is that
// of mirrors and smooth coats. None: nothing glossy.
inline constexpr double kLeastSlope = 0.01;
std::optional<double> microfacet_slope(const materials::Material& material);
// The same of both sides of an instance.
std::optional<double> microfacet_slope(const scene::Scene& scene, const scene::Instance& instance);

// Factor of normals interpolated between two vertices on a circle, θ radians apart: they are off by
// at most kNormalFactor·θ³. From atan(t·sin θ/(1 − t + t·cos θ)) − t·θ at t = 1/2 ∓ 1/√12.
inline constexpr double kNormalFactor = 0.0161;

// Returns the smallest radius of curvature over a relevant share of a shape, metres: the radius of
// a sphere, cylinder or tube, the tube's radius of a torus, c²/a of an ellipsoid; the smaller of
// 2·focal length and radius of a dish; half of the mean radius of a cone or lathe; of rounded edges
// that of a ball in the box, for their share falls with their radius; half of the area of a cage
// over its total mean curvature. None: flat faces and meshes.
std::optional<double> radius_of_curvature(const geometry::Shape& shape);

// Returns true if the shape has explicit counts, or is a mesh.
bool has_explicit_counts(const geometry::Shape& shape);

}  // namespace panwright::compiler
