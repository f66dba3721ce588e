// What a surface does with light, for the path tracer. Private to preview/reference.
#pragma once

#include <optional>

#include "base/math.h"
#include "materials/material.h"

namespace panwright::preview::reference {

// A direction that light may have come from, and what it counts for.
struct Scattered {
  Vec3 to_light;
  Vec3 weight;         // f·cos / pdf
  double pdf = 0;      // per steradian; of pdf()
  bool delta = false;  // of a mirror: the only direction, pdf means nothing
};

// A material's law and how it is sampled. Directions are unit vectors away from the surface.
class Scatter {
 public:
  explicit Scatter(const materials::Material& material);

  // 1/sr; 0 where the light is below the horizon.
  Vec3 brdf(const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal,
            const Vec3& tint) const;

  // Whether its lobe is so narrow that directions to the Sun's disc, taken at random, miss the
  // most of it: sample() has then to look for the Sun, too.
  bool is_narrow() const { return narrow_; }

  // Whether sample() may return anything but nothing.
  bool reflects() const { return diffuse_share_ + facet_share_ > 0; }

  //   u       in the unit square
  //   u_lobe  in the unit interval
  std::optional<Scattered> sample(const Vec3& to_viewer, const Vec3& normal, const Vec3& tint,
                                  const Vec2& u, double u_lobe) const;
  double pdf(const Vec3& to_light, const Vec3& to_viewer, const Vec3& normal) const;

 private:
  double facet_pdf(const Vec3& half, const Vec3& to_viewer, const Vec3& normal) const;

  materials::Material material_;
  double diffuse_share_ = 0;  // of samples from the cosine lobe
  double facet_share_ = 0;    // of samples from facets
  double exponent_ = 0;       // Blinn-Phong; facets of Beckmann slopes when slope_ > 0
  double slope_ = 0;
  bool narrow_ = false;
};

}  // namespace panwright::preview::reference
