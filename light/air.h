// Air above a planet: light that it scatters and what it leaves of other light.
//
// Lengths are in radii of the ground, a sphere of radius 1; radiances are per unit irradiance of
// the Sun, in bands at 650, 550 and 450 nm. Rayleigh scattering (optical depth 0.049, 0.097, 0.223:
// Bodhaine et al. 1999), aerosols and ozone; the Sun is a point, rays are straight.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "base/math.h"

namespace panwright::light {

struct AirLight {
  Vec3 light{0};    // scattered towards the viewer
  Vec3 through{1};  // share of what is behind that arrives
};

class Air {
 public:
  // Expects: a radius of the ground in metres, kLeastRadius or more. Cost: 0.1 s of one core.
  explicit Air(double radius);
  static constexpr double kLeastRadius = 1e6;

  double top() const { return top_; }  // distance of its end

  // Matter per band at a distance from the centre, per radius.
  struct Matter {
    Vec3 rayleigh, mie, extinction;  // scattering coefficients; their sum with absorption
  };
  Matter matter(double r) const;

  // Phase functions, 1/sr, by the cosine of the angle between view ray and direction to the Sun.
  static double rayleigh_phase(double cosine);
  static double mie_phase(double cosine);

  // Returns the transmittance from a place out of the air; 0 where the ground is in the way.
  //
  //   r   distance from the centre, 1 to top(); mu: cosine of the zenith angle
  Vec3 transmittance(double r, double mu) const;
  // Returns the angle by which the air bends a ray that comes and goes outside, about the planet,
  // radians: at the ground 70 minutes of arc. r: lowest distance from the centre, 1 or more.
  double bending(double r) const;
  // Returns what the air leaves of such a ray.
  Vec3 grazing(double r) const;
  // Returns the mean radiance of light that was scattered twice or more above black ground.
  Vec3 multiple(double r, double mu_sun) const;

  // Returns the irradiance of the ground, direct and scattered, by the cosine of the Sun's zenith
  // angle; below 0 it is twilight's.
  Vec3 ground(double mu_sun) const;
  // Returns the share of the light of even ground that leaves the air, with what is scattered.
  Vec3 upward(double mu) const;

  // Returns the light of a ray that begins outside, from tables; it ends at the ground or at the
  // other side. `through` is that of the direct ray. Vectors of unit length.
  // Error: 4 % of the light of the integral, or 1e-4.
  AirLight from_outside(const Vec3& origin, const Vec3& ray, const Vec3& to_sun) const;
  // Returns the same by steps along the ray, from anywhere at the ground or above.
  AirLight along(const Vec3& origin, const Vec3& ray, const Vec3& to_sun) const;
  // Returns that of both which an origin allows.
  AirLight light(const Vec3& origin, const Vec3& ray, const Vec3& to_sun) const {
    const bool outside = glm::dot(origin, origin) >= top_ * top_;
    return outside ? from_outside(origin, ray, to_sun) : along(origin, ray, to_sun);
  }

  // Bond albedo per band over black ground, and the factor of Lambert ground's.
  const Vec3& albedo() const { return albedo_; }
  const Vec3& ground_factor() const { return ground_factor_; }

 private:
  struct Sums {
    Vec3 rayleigh{0}, mie{0}, multiple{0}, through{1};
  };
  struct Steps {
    int count;
    bool isotropic;  // light scattered once, evenly
  };
  Sums march(const Vec3& origin, const Vec3& ray, const Vec3& to_sun, const Steps& steps) const;
  void add_segment(const Vec3& origin, const Vec3& ray, const Vec3& to_sun, double low, double high,
                   const Steps& steps, Sums& sums) const;
  AirLight light_of(const Sums& sums, double cosine) const;
  void fill_transmittance();
  void fill_grazing();
  void fill_multiple();
  void fill_ground();
  void fill_seen();
  void fill_albedo();
  // of rays from outside: ground or limb by u; rows are of the Sun's height and azimuth
  AirLight seen(bool limb, double u, double mu_sun, double cosine_azimuth, double cosine) const;

  double radius_, top_;
  std::vector<float> transmittance_;  // Vec3 by r and mu
  std::vector<Vec3> grazing_;         // optical depths of whole rays by their lowest r
  std::vector<float> multiple_;       // Vec3 by r and mu_sun
  std::vector<float> ground_;         // Vec3 by mu_sun
  std::vector<float> upward_;         // Vec3 by mu
  std::vector<float> seen_[2];        // ground, limb: fourth roots of six numbers
  Vec3 albedo_{0}, ground_factor_{1};
};

// Returns the air of the Earth above ground of a radius; the same object for the same radius, made
// at the first call.
std::shared_ptr<const Air> earth_air(double radius);

}  // namespace panwright::light
