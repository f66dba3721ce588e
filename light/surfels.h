// Light that surfaces send one another, as plain data: surfels of a target, a grid that finds those
// near a point, and the irradiance at each.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/axis_box.h"
#include "base/job.h"
#include "base/math.h"
#include "base/stamp.h"

namespace panwright::light {

// A piece of a surface, in the frame of its target's model.
struct Surfel {
  static constexpr std::uint32_t kMostLimits = 3;

  Vec3 position{0};      // metres, the mean of its piece
  Vec3 normal{0, 0, 1};  // unit, on its side of the surface
  double radius = 0;     // metres, within which it lights points of the surface
  // Planes of plates beside it: it lights points p with dot(limit, (p, 1)) >= 0 alone.
  std::array<Vec4, kMostLimits> limits{};
  std::uint32_t limit_count = 0;
};

// Grid of cubes over the surfels of a target. A cube has a list for each of the six directions
// along axes: the surfels that may light a point within it whose normal is nearest to that
// direction. It never changes. Shaders read it as it is (preview/shaders/indirect.glsl).
struct SurfelGrid {
  static constexpr std::uint32_t kMost = 65536;  // surfels of a target
  static constexpr std::uint32_t kMostListed =
      96;  // of a list: beyond it the farthest are left out

  Vec3 origin{0};   // metres, corner of the cube 0 0 0
  double side = 1;  // of a cube, metres
  Stamp stamp = 0;  // of the contents
  // Hash table with open addresses, a power of two: x | y << 16, z | direction << 16, first entry,
  // number of entries | how many of them have limits << 16; 0: empty. A list stands at slot_of() or
  // behind it.
  std::vector<std::array<std::uint32_t, 4>> cells;
  std::uint32_t longest_probe = 1;
  // Of the lists: surfels without limits, the nearest first, then those with some.
  std::vector<std::uint16_t> entries;
  // Of each surfel: position from the origin; its normal, 8 bits each of an octahedron's square,
  // and the number of its limits << 16.
  std::vector<std::array<float, 4>> surfels;
  // Surfel::kMostLimits of each surfel, of points from the origin. Empty: none has any.
  std::vector<std::array<float, 4>> limits;

  static std::uint32_t slot_of(std::uint32_t xy, std::uint32_t zd);
};

// Directions that the light of a surfel comes from, mean of the channels. The radiance of a
// direction is that of its band, by its height above the surface, times von Mises' distribution of
// azimuths.
struct SurfelSides {
  // The mean of directions along the surface, each of length 1.
  glm::vec3 across{0};
  // Shares of the irradiance in bands of the square of the sine of that height: below 1/16 (14.5
  // degrees), below 1/4 (30 degrees), below 1/2 (45 degrees). The rest comes from above.
  float low = 1 / 16.0f, middle = 3 / 16.0f, high = 1 / 4.0f;

  // The shares, 8 bits each: what shaders read.
  float packed() const;
};

// Light of the surfels of a target.
struct SurfelLight {
  std::shared_ptr<const SurfelGrid> grid;  // null: no light
  Stamp stamp = 0;                         // of the irradiance
  // RGB, from all other surfaces; the last: inverse radius, 1/m
  std::vector<std::array<float, 4>> irradiance;
  // Its directions, for lobes. Empty: evenly from all of the upper half.
  std::vector<SurfelSides> sides;
};

// A place of a surface.
struct SurfacePlace {
  Vec3 position{0};
  Vec3 normal{0, 0, 1};
};

// Builds the grid.
//
//   side    of cubes, metres
//   places  spread over all surfaces: lists stand in their cubes and those beside them; empty:
//           wherever surfels reach
// Expects: at most kMost. Throws Cancelled.
SurfelGrid surfel_grid(std::span<const Surfel> surfels, double side,
                       std::span<const SurfacePlace> places = {}, const Job& job = {});

// Returns the irradiance at a point of a surface, as shaders do: the mean of near surfels that face
// the same way, on its side of their limits. 0 far from all.
Vec3 irradiance_at(const SurfelLight& light, const Vec3& point, const Vec3& normal);

}  // namespace panwright::light
