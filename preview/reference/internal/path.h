// Light that arrives along one ray. Private to preview/reference.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/math.h"
#include "preview/reference/internal/bodies.h"
#include "preview/reference/internal/sun.h"
#include "preview/reference/internal/trace_lamps.h"
#include "preview/reference/internal/trace_scene.h"

namespace panwright::preview::reference {

// Random stream key of one sample of an image.
struct StreamKey {
  std::uint32_t pixel = 0;
  std::uint32_t batch = 0;
  std::uint32_t number = 0;  // within the pixel and batch
  std::uint64_t seed = 0;
};

struct RayCounts {
  std::uint64_t camera = 0;
  std::uint64_t shadow = 0;
  std::uint64_t bounce = 0;
};

struct PathResult {
  Vec3 radiance{0};
  bool covered = false;  // a surface was hit
};

// Numbers in the unit square and interval for the first surface.
struct FirstRandoms {
  Vec2 sun{0};  // place on the disc
  Vec2 bounce{0};
  double lobe = 0;
};

// Width of the ground that a ray of the camera stands for.
struct Footprint {
  double metres = 0;  // of parallel rays
  double angle = 0;   // radians between rays
  double of(double distance) const { return metres + angle * distance; }
};

struct PathOptions {
  const TraceLamps* lamps = nullptr;  // null: none
  std::uint32_t bounces = 0;
  bool flat = false;
  Vec3 white{1};                              // of emission 1, times π
  const trace::GroundBeams* beams = nullptr;  // of rays to the Sun; null: none
  Footprint footprint{};                      // of means of albedo maps; 0: the finest pixels
};

// Traces the light along a ray from the camera: emission, and at every surface on the way the Sun
// and one place of each lamp.
// The Sun is sampled by its disc and, for narrow lobes, by the lobe (power heuristic of E. Veach,
// "Robust Monte Carlo methods for light transport simulation", 1997, 9.2); the bodies of the sky by
// their discs and by all lobes, alike.
//
//   suns    one for each target of the world
//   bodies  the same, and then one in the camera's frame; none: no bodies
PathResult traced(const TraceScene& scene, std::span<const Sun> suns,
                  std::span<const Bodies> bodies, const trace::Ray& ray, const FirstRandoms& first,
                  const StreamKey& name, const PathOptions& options, RayCounts& counts);

// The same for what the ray meets first. Expects: a hit of the scene.
PathResult traced_from(const TraceScene& scene, std::span<const Sun> suns,
                       std::span<const Bodies> bodies, const trace::Hit& first_hit,
                       const FirstRandoms& first, const StreamKey& name, const PathOptions& options,
                       RayCounts& counts);

// Hit of the camera's ray, and a place on the Sun's disc, in the unit square.
struct SunSample {
  const trace::Hit* hit;
  Vec2 sun;
};

// Sets the radiances of traced_from() where there are no bounces, lamps and bodies, bit-equal;
// BRDFs are evaluated together. False: a surface needs more than that; none is set then.
bool sunlit(const TraceScene& scene, std::span<const Sun> suns, std::span<const SunSample> samples,
            const PathOptions& options, std::span<Vec3> radiances);

// BRDF times the cosine of incidence, the mean of facets.
Vec3 reflected(const Point& point, const Vec3& to_light, const Vec3& to_viewer);

// Returns the numbers in (0, 1) of a sample for one use.
std::array<double, 4> numbers(const StreamKey& name, std::uint32_t use);
// Uses: 0 and 1 are free for the ray's maker; traced() has those from 2.

}  // namespace panwright::preview::reference
