// Surfaces of revolution: parts of a profile, revolved about the z axis in segments.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "geometry/tessellate/internal/profile.h"
#include "geometry/tessellate/tessellate.h"

namespace panwright::geometry::internal {

// Source of texture coordinates: u from the angle and v along the profile, or the square around the
// shape seen from above or from below.
enum class Mapping { angle, above, below };

// Stretch of a profile (r, z) with the outside on its right, separated from its neighbours by an
// edge.
struct Part {
  std::optional<Curve> curve;  // none: straight
  Vec2 from{0}, to{0};
  bool cap = false;  // a flat face from or to the axis: triangles without a vertex in the middle
  Mapping mapping = Mapping::angle;
  double v_begin = 0, v_end = 1;  // of Mapping::angle
  double plane_radius = 1;        // of the circle in the square of the others

  static Part straight(const Vec2& from, const Vec2& to);
  static Part face(const Vec2& from, const Vec2& to);  // of constant z; a cap or ring
  static Part curved(Curve curve);
};

struct Revolution {
  std::string_view kind;
  std::vector<Part> parts = {};
  Sector sector = {};
  Counts counts = {};
  // the outline of the flat walls at both ends of a sector, convex, from the axis; or empty
  std::vector<Vec2> wall = {};
  bool closed = false;
};

// Segments and chords of a revolution.
struct Layout {
  enum class State { good, too_fine, too_many };
  State state = State::good;
  std::uint32_t segments = 0;
  double edge_factor = 1;  // on the radius of circular edges
  // For straight profiles between circular edges of two radii: segments of the smaller one, k for
  // each k + 1 of the others, one of each at the same angle. No side of a triangle spans more than
  // a segment of the larger one. So interpolated normals and textures are as good as on a grid.
  std::uint32_t narrow_segments = 0;  // 0: there are none
  double narrow_radius = 0;
  double narrow_factor = 1;
  bool is_narrow(double radius) const {
    return narrow_segments != 0 && radius > 0 && radius <= narrow_radius;
  }
  std::uint32_t segments_at(double radius) const {
    return is_narrow(radius) ? narrow_segments : segments;
  }
  double factor_at(double radius) const { return is_narrow(radius) ? narrow_factor : edge_factor; }
  std::vector<std::vector<ProfilePoint>> parts;  // one per part
  double error = 0;                              // in exact arithmetic, metres
  double least_error = 0;                        // limit of float32, metres
  double triangles = 0;
  double vertices = 0;
};

// shared_circular_edges: circular edges stand on the shape even if options.edge_segments is 0
Layout laid_out(const Revolution& revolution, const TessellationOptions& options,
                bool shared_circular_edges = false);

Result<Mesh> revolved(const Revolution& revolution, const TessellationOptions& options,
                      SourceSpan where, DiagnosticLog& log);

// Results of planned() and segments() of a shape.
double planned_triangles(const Revolution& revolution, const TessellationOptions& options);
std::uint32_t shared_segments(const Revolution& revolution, const TessellationOptions& options);

// Returns a circular edge of a revolution.
CircularEdge circular_edge(double radius, double z, const Sector& sector);

// Sets the error of a mesh: that of the shape and of rounding to float32 about the centre of the
// mesh's bounds.
void set_error(Mesh& mesh, double shape_error);

// Returns an upper bound on the rounding error, for vertices within `reach` of the centre.
double rounding_bound(double reach);

}  // namespace panwright::geometry::internal
