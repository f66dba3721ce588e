// Light that terrain sends to a place, as plain data: where it comes from, and what it hides.
#pragma once

#include <cstdint>
#include <vector>

#include "base/math.h"
#include "base/stamp.h"

namespace panwright::light {

// A part of a source: its direction, and its irradiance on a plane that faces it.
struct ShinePart {
  Vec3 direction{0};  // unit
  Vec3 irradiance{0};
  double flux = 0;  // the sum over the bands
};

// Ground that a target's own shadow makes dark; 32 of it at most.
struct ShineShadow {
  Vec3 place{0}, normal{0};  // metres and unit, of the world
  double area = 0;           // square metres
  Vec3 light{0};             // π times the radiance that is missing towards the target
};

// Light of terrain at the middle of a target. Directions are those of the world.
struct GroundShine {
  // Texels along a side of the octahedron of all directions.
  static constexpr int kSide = 64;
  struct Cap {
    Vec3 axis;  // unit
    double cosine;
  };

  Stamp stamp = 0;       // of its state; 0: no terrain
  Vec3 middle{0};        // metres, of the world
  double closeness = 0;  // half the target's longest side over the distance of the nearest ground
  std::vector<ShinePart> parts;      // of lit ground, as if the target cast no shadow on it
  std::vector<ShineShadow> shadows;  // parts that the target's own shadow darkens
  // By texel, row by row: the radiance, shadows included, and whether there is ground. Empty: all
  // ground is within caps.
  std::vector<Vec3> radiance;
  std::vector<std::uint8_t> is_ground;
  std::vector<Cap> caps;

  // Returns whether ground hides what lies beyond it in a direction: to a texel, or within a cap.
  bool hides(const Vec3& direction) const;
};

// Directions of the world as an octahedron unfolded into a square, x + y·side of z ≥ 0 in the
// middle: the direction of a place, −1 to 1 along x and y, of any length; and back.
Vec3 octahedron_direction(const Vec2& place);
Vec2 octahedron_place(const Vec3& direction);

}  // namespace panwright::light
