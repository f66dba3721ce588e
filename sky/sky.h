// Bodies of a world: the radiance of their surfaces, and what they leave of the Sun.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/math.h"
#include "light/air.h"
#include "light/body.h"
#include "world/world.h"

namespace panwright::sky {

// Ellipsoid as the unit sphere of its own space. A point outside sees places u, |u| = 1, along
// directions of that space, which need no unit length in the world.
struct Ellipsoid {
  explicit Ellipsoid(const light::Body& body);
  // A point from the centre, in units of the semi-axes.
  Vec3 from(const Vec3& world_point) const { return unit_from_world * (world_point - centre); }
  Vec3 world(const Vec3& unit_place) const { return centre + world_from_unit * unit_place; }

  Vec3 centre;           // metres
  Mat3 unit_from_world;  // of directions
  Mat3 world_from_unit;
  Mat3 world_from_normal;  // of normals, any length
  double volume;           // product of the semi-axes, m³
  double radius;           // its cube root
};

// Edge of a shadow near a point, straight: t = value + gradient·(place − point) is how far the
// Sun's centre stands beyond the limb, in radii of its disc.
struct EclipseEdge {
  double value = 1;
  Vec3 gradient{0};  // 1/m
};

// Body whose shadow falls near a point, in the space of its ellipsoid.
struct NearEclipse {
  std::size_t body = 0;
  Vec3 from{0};  // the point from its centre
  Mat3 unit_from_world{1};
  Vec3 to_sun{0};            // to the middle of the Sun's disc
  Vec3 along{0}, across{0};  // from there by a radius of the disc; `along` towards the body
};

// The last sunlight near a point behind a body, through the ring of its air (light::Body::sunset):
// bent towards the shadow's middle, dimmed and reddened.
struct Sunset {
  static constexpr std::size_t kNodes = 64;
  std::size_t body = 0;
  EclipseEdge edge;  // of the hard limb
  // Shares of the Sun's light per band, for t from first on.
  double first = 0, step = 1;
  std::array<Vec3, kNodes> shares{};
  std::array<Vec3, kNodes> through{};  // the same of a point of the disc, where air spreads it too
  double last() const { return first + step * (kNodes - 1); }  // from here on 1
  Vec3 at(double t) const;
};

// Returns the share of the Sun's light beyond a straight edge: 0 at t = −1, 1 at t = 1.
double share_beyond(double t, double limb_darkening);

// The bodies and the Sun of a world. The Sun is at infinity: its direction is the same everywhere.
class Sky {
 public:
  explicit Sky(const world::World& world);

  std::size_t size() const { return bodies_.size(); }
  const light::Body& body(std::size_t index) const { return bodies_[index]; }
  const Ellipsoid& shape(std::size_t index) const { return shapes_[index]; }
  const light::Air* air(std::size_t index) const { return airs_[index].get(); }  // null: none
  const Vec3& to_sun() const { return to_sun_; }                                 // unit
  double sun_sine() const { return sun_sine_; }  // of its angular radius
  const Vec3& irradiance() const { return irradiance_; }
  double limb_darkening() const { return limb_; }
  bool sun_visible() const { return sun_visible_; }

  // Returns the radiance of a place of a body, eclipsed by the others.
  //
  //   place      |u| = 1, in the ellipsoid's space
  //   to_viewer  world axes, unit
  //   footprint  angle from the centre that maps are averaged over, radians
  //   viewer     in the ellipsoid's space, where it may be in the air; null: outside
  Vec3 radiance(std::size_t index, const Vec3& place, const Vec3& to_viewer, double footprint,
                const Vec3* viewer = nullptr) const;

  // Returns what the air of a body adds to a ray that misses the ground, and what it leaves of
  // what is behind.
  //
  //   viewer  in the ellipsoid's space; ray: world axes, any length
  light::AirLight air_light(std::size_t index, const Vec3& viewer, const Vec3& ray) const;

  // Returns the radiance of the Sun's disc.
  //
  //   square  (distance from its centre / its radius)², 0 to 1
  Vec3 sun_radiance(double square) const;

  // Returns the share of the Sun's light that reaches a point, 0 to 1: of the disc with its limb
  // darkening, by chords, less the ellipsoids' exact outlines. 0 within a body.
  //
  //   except  a body that is left out
  // Error: 2e-4 of the whole (bodies much smaller than the Sun). Cost: O(bodies), 256 chords where
  // one is partial.
  double sun_share(const Vec3& point, std::optional<std::size_t> except = {}) const;

  // Returns whether a body hides the Sun's centre at a point; true within a body.
  bool sun_hidden(const Vec3& point) const;

  // Returns the edge of the deepest shadow near a point, for places within a radius of it; none:
  // all of them are lit. Its share at the point is that of sun_share().
  std::optional<EclipseEdge> eclipse_edge(const Vec3& point, double radius) const;

  // Returns the bodies, two at most, whose shadows fall within a radius of a point and have no
  // straight edge there, the deepest first: limbs that bend, bodies that are not much wider than
  // the Sun's disc, two at once. Empty: eclipse_edge() errs by 1e-3 of the Sun at most.
  //
  //   except  a body that is left out; of the others two at most, whatever their edges. `along` is
  //           then along its limb, `across` away from it.
  std::vector<NearEclipse> near_eclipses(const Vec3& point, double radius,
                                         std::optional<std::size_t> except = {}) const;

  // Returns the deepest sunset near a point, for places within a radius of it; none: of no body, or
  // all of them have the whole Sun.
  //
  // Error: 3e-3 of the Sun's light. Cost: 5 ms; of sunset_near(), whether there is one, nothing.
  std::optional<Sunset> sunset(const Vec3& point, double radius) const;
  bool sunset_near(const Vec3& point, double radius) const;

  // Returns the share of the Sun's light per band that reaches a point, with the deepest sunset; of
  // others sun_share(). Error: 1e-3. Cost: 20 ms where another body hides a part of a sunset.
  Vec3 sunlight(const Vec3& point) const;

  // Returns the unit direction from the Sun's middle towards another, perpendicular to the Sun's.
  Vec3 beside_sun(const Vec3& toward) const;

 private:
  // The mean of a weight over what other bodies leave of the Sun's disc, 0 where they hide it.
  //
  //   along   axis of x, unit, perpendicular to the Sun's direction
  //   weight  by a place on the disc, in its radii
  Vec3 mean_beside(const Vec3& point, std::size_t except, const Vec3& along,
                   const std::function<Vec3(double x, double y)>& weight) const;

  std::vector<light::Body> bodies_;
  std::vector<Ellipsoid> shapes_;
  std::vector<std::shared_ptr<const light::Air>> airs_;
  std::vector<Vec3> suns_;  // directions in the ellipsoids' spaces, unit
  Vec3 to_sun_, across_[2];
  Vec3 irradiance_;
  Vec3 unit_{1};  // of radiance, W/m²/sr
  double sun_sine_ = 0, limb_ = 0;
  bool sun_visible_ = false;
};

}  // namespace panwright::sky
