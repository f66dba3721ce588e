// The Sun as a disc at infinity. Private to preview/reference.
#pragma once

#include "base/math.h"
#include "world/world.h"

namespace panwright::preview::reference {

// Sun in the frame of a target's model. The whole disc gives `irradiance` to a plane that faces its
// centre.
class Sun {
 public:
  // disc: false makes it a point.
  Sun(const world::Sun& sun, const Mat3& world_from_model, bool disc);

  bool has_disc() const { return sine_ > 0; }
  const Vec3& irradiance() const { return irradiance_; }

  // Direction to the Sun, and its irradiance on a plane perpendicular to it: the mean over u in the
  // unit square is exact.
  struct Sample {
    Vec3 to_light;  // unit
    Vec3 irradiance;
  };
  Sample sample(const Vec2& u) const;

  // The same for a place in the unit disc: divide by pi times the density of places.
  Sample at(const Vec2& place) const;
  // Returns the place of a direction, beyond 1 beside the disc or behind. Expects: has_disc().
  Vec2 place(const Vec3& direction) const;
  const Vec3& centre() const { return centre_; }
  double sine() const { return sine_; }  // of the angular radius; 0: a point

  // Returns the radiance; 0 beside the disc. Expects: has_disc().
  Vec3 radiance(const Vec3& direction) const;

 private:
  double brightness(double square) const;  // relative to the mean; of (r / disc's radius)²

  Vec3 centre_;
  Vec3 across_[2];
  Vec3 irradiance_;
  double sine_ = 0;  // of the angular radius; 0: a point
  double darkening_ = 0;
};

}  // namespace panwright::preview::reference
