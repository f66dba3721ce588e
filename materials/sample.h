// Scattering by a material, for path tracing: consistent evaluation, sampling and density.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>

#include "base/math.h"
#include "materials/material.h"

namespace panwright::materials {

// Direction drawn for a viewer.
struct Sampled {
  Vec3 to_light{0};    // unit
  Vec3 weight{0};      // f cosθ over the density: factor of its radiance
  double pdf = 0;      // 1/sr; 0 where delta
  bool delta = false;  // a mirror's direction: no other sample reaches it
};

// Mirrored direction and its reflectance.
struct Mirrored {
  Vec3 to_light{0};     // unit
  Vec3 reflectance{0};  // of radiance
};

// Mirrors, at most two: a smooth coat's, and that of a mirror below, which may be tilted against
// it.
struct Mirrors {
  std::array<Mirrored, 2> all;
  int count = 0;
};

// Gaussian lobe on the Sun's disc: exp(-(across/narrow)² - (along/wide)²) about `peak`, in radii of
// the disc along axis_x and axis_y of its frame; across: along `axis`, along: left of it. The
// light's direction is linearised about the place of most of its light.
struct DiscLobe {
  Vec2 peak{0};
  Vec2 axis{1, 0};
  double narrow = 1;
  double wide = 1;
};
struct DiscLobes {
  std::array<DiscLobe, 2> all;
  int count = 0;
};

// Authored BRDFs of one material in double, for a light without a disc: mirrors and smooth coats
// are directions, which brdf() excludes. H of Hapke's model is exact here, while f64::brdf() of
// materials/brdf.h has the shaders' fit.
//
// Directions are unit vectors that point away from the surface; tangent: unit, perpendicular to the
// normal, or 0 for isotropic microfacets; tint multiplies diffuse. A viewer below the horizon is
// moved to it, as in brdf() of materials/brdf.h. Results are finite. Thread-safe.
class Scattering {
 public:
  // Expects: fitted, see fit()
  explicit Scattering(const Material& material);
  ~Scattering();
  Scattering(const Scattering&);
  Scattering& operator=(const Scattering&);
  Scattering(Scattering&&) noexcept;
  Scattering& operator=(Scattering&&) noexcept;

  // Returns the same with slopes and σ times the value of a roughness map, >= 0.
  Scattering scaled(double roughness) const;
  // Returns the lobes on the Sun's disc, of an angular radius (its sine) above 0: those of
  // Beckmann's slopes and of Blinn and Phong. Axes: those of the frame of T. Duff et al. about
  // to_sun.
  DiscLobes disc_lobes(const Vec3& to_sun, double radius, const Vec3& to_viewer, const Vec3& normal,
                       const Vec3& tangent) const;

  // Returns the same with the value of a reflectance map as F0, 0 to 1; unchanged without such a
  // map.
  Scattering reflecting(const Vec3& reflectance) const;

  // Returns f, 1/sr, without mirrors; 0 for light below the horizon.
  Vec3 brdf(const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal, const Vec3& tangent,
            const Vec3& tint) const;

  // The same of many, bit-equal, of isotropic surfaces; Hapke's alone is four times as fast.
  struct Directions {
    Vec3 to_light, to_viewer, normal, tint;
  };
  void brdf(std::span<const Directions> at, std::span<Vec3> out) const;

  // Returns the density of sample() at to_light, 1/sr. Its integral over the upper hemisphere is
  // the probability of a direction that is not a mirror's.
  double pdf(const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal, const Vec3& tangent,
             const Vec3& tint) const;

  // Draws a direction. u, u_lobe: uniform in [0, 1). None for directions below the horizon: their
  // weight is 0. The mean of weight is the directional albedo. E. Heitz, "Sampling the GGX
  // distribution of visible normals", 2018; J. Dupuy, A. Benyoub, "Sampling visible GGX normals
  // with spherical caps", 2023.
  std::optional<Sampled> sample(const Vec3& to_viewer, const Vec3& normal, const Vec3& tangent,
                                const Vec3& tint, const Vec2& u, double u_lobe) const;

  // Returns every mirrored direction of a viewer, for lights found by tracing.
  Mirrors mirrors(const Vec3& to_viewer, const Vec3& normal, const Vec3& tangent) const;

  // Returns the reflectance of all untilted mirrors together; 0 without one. cosine: that of the
  // viewer.
  Vec3 mirror_reflectance(double cosine) const;
  bool has_delta() const;

 private:
  struct Parts;
  explicit Scattering(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace panwright::materials
