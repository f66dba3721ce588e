// Bodies of the sky as rays meet them. Private to preview/reference.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/math.h"
#include "light/body.h"
#include "preview/reference/internal/sun.h"
#include "trace/placement.h"
#include "world/world.h"

namespace panwright::preview::reference {

// The bodies in the frame of a target's model, or of the camera. Origins and directions are in that
// frame, metres and unit.
class Bodies {
 public:
  //   unit  of radiance, W/m²/sr
  // Expects: the bodies outlive this; the Sun in the same frame.
  Bodies(std::span<const light::Body> bodies, const trace::RigidFrame& frame, const Sun& sun,
         const Vec3& unit);

  bool empty() const { return bodies_.empty(); }

  // Returns the share of light from infinity that arrives from a direction, per band: 0 where a
  // body stands, unless its air bends light around it (light::Body::sunset).
  Vec3 passes(const Vec3& origin, const Vec3& direction) const;

  struct Hit {
    std::size_t body = 0;
    double distance = 0;
    Vec3 place{0};  // on the unit sphere of the body
  };
  std::optional<Hit> nearest(const Vec3& origin, const Vec3& direction) const;

  // Returns what a ray gets of the bodies and of their air; other bodies eclipse both.
  //
  //   u       place on the Sun's disc, where its light comes from
  //   behind  radiance behind all bodies
  Vec3 light(const Vec3& origin, const Vec3& direction, const Vec2& u,
             const Vec3& behind = Vec3(0)) const;

  // Draws a direction to the disc of a body or its air, even over the directions of its unit
  // sphere. None within a body.
  struct Sample {
    Vec3 direction{0};
    double pdf = 0;  // 1/sr, of all bodies together
  };
  std::optional<Sample> sample(const Vec3& origin, const Vec2& u, double u_body) const;
  // Returns the density of sample() in a direction, 1/sr; 0 beside the discs.
  double pdf(const Vec3& origin, const Vec3& direction) const;

 private:
  struct Placed {
    const light::Body* body;
    Vec3 centre;
    Mat3 turn;  // the frame from the body
    double volume;
    std::shared_ptr<const light::Air> air;  // null: none
    Vec3 to_unit(const Vec3& v) const { return (v * turn) / body->radii; }
    Vec3 from_unit(const Vec3& v) const { return turn * (v * body->radii); }
  };
  // Distance in the space where what sample() aims at, the ground or its air, is the unit sphere.
  static Vec3 sampled_from(const Placed& one, const Vec3& origin);
  bool eclipsed(std::size_t body, const Vec3& at, const Vec2& u) const;
  static Vec3 through_ring(const Placed& one, const Vec3& from, const Vec3& ray);
  Vec3 radiance(const Vec3& origin, const Vec3& direction, const Hit& hit, const Vec2& u) const;
  // Share of a body among all in sample(): its disc in steradians of its own sphere.
  static double disc_of(const Placed& one, const Vec3& origin);
  double pdf_of(const Placed& one, const Vec3& origin, const Vec3& direction) const;

  std::vector<Placed> bodies_;
  Sun sun_;
  Vec3 unit_;
};

// Returns the unit of an image's radiance, W/m²/sr.
Vec3 radiance_unit(const world::World& world);

}  // namespace panwright::preview::reference
