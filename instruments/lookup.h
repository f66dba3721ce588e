// Look-ups of a world: what rays, pixels and points meet, in double at any range. No OpenGL.
//
//   instruments::Lookups lookups;
//   lookups.update(world);
//   std::vector<instruments::SurfacePoint> points(pixels.size());
//   lookups.pixels(camera, pixels, points);
//
// The answers are those of an image's ground truth: terrain, holes, hidden nodes and the insides of
// closed meshes count as there; terrain with its finest triangles. All positions and directions are
// in world axes, metres. A hit lies on its triangle to some 1e-15 of the mesh's size, and along its
// ray to the rounding of the origin.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "labels/labels.h"
#include "trace/scene.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::instruments {

// Point of a surface, as a look-up found it.
struct SurfacePoint {
  // Metres: along the ray from its origin; of nearest(): from the point. inf: nothing found.
  double distance = std::numeric_limits<double>::infinity();
  Vec3 position{0};  // world axes
  // The same in the frame of the target's model, joints included: the accurate one where
  // coordinates of the world are large.
  Vec3 in_model{0};
  // World axes, unit, on the side that the ray meets, or that the point is on: of the triangle, and
  // interpolated without normal maps.
  Vec3 facet{0};
  Vec3 normal{0};
  trace::Ids ids;  // all 0: nothing found

  explicit operator bool() const { return distance < std::numeric_limits<double>::infinity(); }
};

// Two points, metres, world axes.
struct Sight {
  Vec3 from{0}, to{0};
};

// Answers for the targets of a world. Search trees and placements are kept from update to update,
// by the world's stamps. Questions may come from any thread while nothing is updated; answers to
// many are the same for any number of threads.
class Lookups {
 public:
  Lookups();
  ~Lookups();
  Lookups(Lookups&&) noexcept;
  Lookups& operator=(Lookups&&) noexcept;

  // Builds what is missing. Throws Cancelled: may be called again then. Cost: as trace::Scene.
  void update(const world::World& world, const Job& job = {});
  const world::World& world() const;  // copy of that of the last update
  // Reports damaged tiles of terrain that questions have met, once each: W9615.
  void report_damaged(DiagnosticLog& log) const;

  // Expects of all: an update before; answers as many as questions; finite coordinates.
  // Throws Cancelled: some answers are set then. Cost: O(log T) each, expected.

  // Nearest surfaces to rays of the world's frame, within their ranges.
  // Expects: unit directions.
  void rays(std::span<const geometry::Ray> rays, std::span<SurfacePoint> found,
            const Job& job = {}) const;

  // Surfaces at places of an image, pixels; not found: background, or outside of the lens's domain.
  // Distances are ranges from the camera; orthographic: from the plane through its position.
  void pixels(const world::Camera& camera, std::span<const Vec2> places,
              std::span<SurfacePoint> found, const Job& job = {}) const;

  // Lines of sight between two points: 1 where nothing stands between, else 0. The same in both
  // directions: insides of closed meshes block too.
  //
  //   slack  metres at both ends where surfaces do not count, as those that the points lie on
  void sights(std::span<const Sight> sights, double slack, std::span<std::uint8_t> open,
              const Job& job = {}) const;

  // Highest surface above and below a place (x, y), along the world's z axis. Distances are its
  // elevation, `position.z`.
  void elevations(std::span<const Vec2> places, std::span<SurfacePoint> found,
                  const Job& job = {}) const;

  // Points of visible surfaces that are nearest to points, from any side. Of equally near ones the
  // lower target, instance and triangle. Holes that a texture cuts count as surface. Of terrain, as
  // terrain::Ground::closest().
  //
  // Cost: for meshes that are new to it, O(T log T) and 260 bytes a triangle.
  void nearest(std::span<const Vec3> points, std::span<SurfacePoint> found, const Job& job = {});

  // Keypoints of all targets in the world's order, as labels have them (labels/labels.h).
  //
  //   slack  metres: surfaces nearer than this to a keypoint neither hide nor shade it
  std::vector<std::vector<labels::Keypoint>> keypoints(const world::Camera& camera,
                                                       double slack = 1e-4) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace panwright::instruments
