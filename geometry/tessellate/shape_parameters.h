// Parameters of shapes by their names in the language: one list for readers, writers and hashes.
#pragma once

#include <concepts>
#include <type_traits>

#include "geometry/tessellate/shape.h"

namespace panwright::geometry {

template <class S, class T>
concept AnyOf = std::same_as<std::remove_const_t<S>, T>;

// Calls visit(name, members…) for each parameter of a shape, in the order of written files: with
// one or more doubles, or a Vec3, in metres and radians; with a bool or Caps, which is the index of
// its word; with a std::uint32_t, a count, 0 if absent; with a list of points or of faces. Members
// of a const shape are const. Some parameters are not in the language, as `rings` of a cylinder.
template <AnyOf<Sphere> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  SphereCounts counts = s.counts.value_or(SphereCounts{0, 0});
  visit("radius", s.radius);
  visit("latitude", s.latitude_min, s.latitude_max);
  visit("sector", s.sector.begin, s.sector.end);
  visit("rings", counts.rings);
  visit("quads", counts.quads);
  if constexpr (!std::is_const_v<S>)
    if (counts.rings > 0 && counts.quads > 0) s.counts = counts;
}

template <AnyOf<Ellipsoid> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("radii", s.radii);
  visit("segments", s.counts.around);
  visit("rings", s.counts.along);
}

template <AnyOf<Box> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("size", s.size);
  visit("bevel", s.bevel);
  visit("edges", s.round);
}

template <AnyOf<Cylinder> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("radius", s.radius);
  visit("height", s.height);
  visit("caps", s.caps);
  visit("sector", s.sector.begin, s.sector.end);
  visit("segments", s.counts.around);
  visit("rings", s.counts.along);
}

template <AnyOf<Cone> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("radius", s.bottom_radius);
  visit("top_radius", s.top_radius);
  visit("height", s.height);
  visit("caps", s.caps);
  visit("sector", s.sector.begin, s.sector.end);
  visit("segments", s.counts.around);
  visit("rings", s.counts.along);
}

template <AnyOf<Disc> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("radius", s.radius);
  visit("inner_radius", s.inner_radius);
  visit("sector", s.sector.begin, s.sector.end);
  visit("segments", s.counts.around);
  visit("rings", s.counts.along);
}

template <AnyOf<Torus> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("radius", s.radius);
  visit("tube_radius", s.tube_radius);
  visit("sector", s.sector.begin, s.sector.end);
  visit("segments", s.counts.around);
  visit("rings", s.counts.along);
}

template <AnyOf<Dish> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("diameter", s.diameter);
  visit("focal_length", s.focal_length);
  visit("thickness", s.thickness);
  visit("segments", s.counts.around);
  visit("rings", s.counts.along);
}

template <AnyOf<Plane> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("size", s.width, s.height);
}

template <AnyOf<Tube> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("path", s.path);
  visit("radius", s.radius);
  visit("inner_radius", s.inner_radius);
  visit("curve", s.spline);
  visit("closed", s.closed);
  visit("caps", s.caps);
  visit("segments", s.counts.around);
  visit("rings", s.counts.along);
}

template <AnyOf<Lathe> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("profile", s.profile);
  visit("curve", s.spline);
  visit("sector", s.sector.begin, s.sector.end);
  visit("segments", s.counts.around);
  visit("rings", s.counts.along);
}

template <AnyOf<Extrude> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("outline", s.outline);
  visit("hole", s.holes);
  visit("height", s.height);
  visit("smooth", s.smooth);
  visit("caps", s.caps);
}

template <AnyOf<Polygons> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("vertices", s.positions);
  visit("smooth", s.smooth);
  visit("face", s.faces);
}

template <AnyOf<Subdiv> S, class Visit>
void visit_parameters(S& s, Visit&& visit) {
  visit("vertices", s.positions);
  visit("texcoords", s.texcoords);
  visit("face", s.faces);
  visit("crease", s.creases);
  visit("corner", s.corners);
  visit("border", s.smooth_border);
  visit("levels", s.levels);
}

}  // namespace panwright::geometry
