// Implementations of geometry/tessellate/shape.h and geometry/tessellate/tessellate.h by kind of
// shape.
#pragma once

#include "geometry/tessellate/tessellate.h"

namespace panwright::geometry::internal {

using Problem = std::optional<ShapeProblem>;

// ---- shapes about an axis

Problem problem(const Sphere& shape);
Problem problem(const Ellipsoid& shape);
Problem problem(const Cylinder& shape);
Problem problem(const Cone& shape);
Problem problem(const Disc& shape);
Problem problem(const Torus& shape);
Problem problem(const Dish& shape);
Problem problem(const Lathe& shape);

// Returns the profile; that of a spline with `chords` chords for each piece.
std::vector<Vec2> sampled_profile(const Lathe& shape, int chords);

Result<Mesh> make(const Sphere& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);
Result<Mesh> make(const Ellipsoid& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);
Result<Mesh> make(const Cylinder& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);
Result<Mesh> make(const Cone& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);
Result<Mesh> make(const Disc& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);
Result<Mesh> make(const Torus& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);
Result<Mesh> make(const Dish& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);
Result<Mesh> make(const Lathe& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);

double planned(const Sphere& shape, const TessellationOptions&);
double planned(const Ellipsoid& shape, const TessellationOptions&);
double planned(const Cylinder& shape, const TessellationOptions&);
double planned(const Cone& shape, const TessellationOptions&);
double planned(const Disc& shape, const TessellationOptions&);
double planned(const Torus& shape, const TessellationOptions&);
double planned(const Dish& shape, const TessellationOptions&);
double planned(const Lathe& shape, const TessellationOptions&);

std::vector<CircularEdge> circular_edges(const Sphere& shape);
std::vector<CircularEdge> circular_edges(const Cylinder& shape);
std::vector<CircularEdge> circular_edges(const Cone& shape);
std::vector<CircularEdge> circular_edges(const Disc& shape);
std::vector<CircularEdge> circular_edges(const Dish& shape);
std::vector<CircularEdge> circular_edges(const Lathe& shape);

std::uint32_t segments(const Sphere& shape, const TessellationOptions&);
std::uint32_t segments(const Cylinder& shape, const TessellationOptions&);
std::uint32_t segments(const Cone& shape, const TessellationOptions&);
std::uint32_t segments(const Disc& shape, const TessellationOptions&);
std::uint32_t segments(const Dish& shape, const TessellationOptions&);
std::uint32_t segments(const Lathe& shape, const TessellationOptions&);

// ---- blocks, faces and pipes

Problem problem(const Box& shape);
Problem problem(const Plane& shape);
Problem problem(const Tube& shape);
Problem problem(const Extrude& shape);
Problem problem(const Polygons& shape);

Result<Mesh> make(const Box& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);
Result<Mesh> make(const Plane& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);
Result<Mesh> make(const Tube& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);
Result<Mesh> make(const Extrude& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);
Result<Mesh> make(const Polygons& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);

double planned(const Box& shape, const TessellationOptions&);
double planned(const Plane& shape, const TessellationOptions&);
double planned(const Tube& shape, const TessellationOptions&);
double planned(const Extrude& shape, const TessellationOptions&);
double planned(const Polygons& shape, const TessellationOptions&);

std::vector<CircularEdge> circular_edges(const Tube& shape);
std::uint32_t segments(const Tube& shape, const TessellationOptions&);

// ---- subdiv*.cpp: cages

Problem problem(const Subdiv& shape);
Result<Mesh> make(const Subdiv& shape, const TessellationOptions&, SourceSpan, DiagnosticLog&);
double planned(const Subdiv& shape, const TessellationOptions&);
std::vector<ShapeProblem> warnings(const Subdiv& shape);
// Returns true if two faces meet at each edge of the cage.
bool has_no_border(const Subdiv& shape);

}  // namespace panwright::geometry::internal
