// Positions of the sections of a tube, and their number of corners.
#pragma once

#include <vector>

#include "geometry/tessellate/internal/path.h"
#include "geometry/tessellate/tessellate.h"

namespace panwright::geometry::internal {

// Corners of a section: centre + radius·(cos·right + sin·up).
struct Ring {
  Vec3 centre, right, up;
};

// Row of vertices on a ring, its corners counted from `shift` on; right and up are unit, for
// normals.
struct Row {
  std::uint32_t ring;
  std::uint32_t shift;
  Vec3 right, up;
  double v;
};

struct Band {
  std::uint32_t from, to;  // rows
  std::uint32_t shift;     // of the second row
};

struct TubePlan {
  enum class State { good, too_fine, too_many };
  State state = State::good;
  std::uint32_t segments = 3;
  double factor = 1;     // on both radii
  double error = 0;      // in exact arithmetic, metres
  bool turning = false;  // rows are rotated onward, so that the other diagonals are shorter
  std::vector<Ring> rings;
  std::vector<Row> rows;
  std::vector<Band> bands;
  double triangles = 0;
};

// Expects: no problem(tube).
TubePlan plan_of(const Tube& tube, const TessellationOptions& options);

// Returns the frames at the ends of an open tube, in the direction of its path.
std::vector<Frame> end_frames(const Tube& tube);

// Straights between a polyline's corners, with the frame at its begin. Points on a straight line
// are left out.
struct Straights {
  std::vector<std::size_t> corner;  // points of the path at which straights begin
  std::vector<Frame> frame;
  std::vector<double> length;
};
Straights straights_of(const Tube& tube);

// Returns the lean of a straight's end: sections are cut along `lean` by the tangent, metres for
// each metre away from the axis. Between the tangents of neighbours; their sum must not be zero.
Vec3 lean_of(const Vec3& tangent, const Vec3& other);

}  // namespace panwright::geometry::internal
