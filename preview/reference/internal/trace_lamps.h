// Lights beside the Sun in the path tracer. Private to preview/reference.
#pragma once

#include <optional>
#include <vector>

#include "base/math.h"
#include "preview/reference/internal/sun.h"
#include "trace/scene.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::preview::reference {

// A lamp in the frame of a target's model: a sphere, a disc of one side, or a disc at infinity.
class TraceLamp {
 public:
  TraceLamp(const light::Source& source, const trace::Affine& target_from_carrier);

  // Light from one place on it: the mean over u in the unit square is exact.
  struct Sample {
    Vec3 to_light{0};     // unit
    double distance = 0;  // to the place, metres
    Vec3 irradiance{0};   // on a plane perpendicular to it
  };
  Sample sample(const Vec3& from, const Vec2& u) const;

  // Returns what is seen in a direction. irradiance: the radiance there; 0: nothing of it, or a
  // point.
  Sample seen(const Vec3& from, const Vec3& direction) const;

 private:
  double share(const Vec3& from_lamp) const;  // of the intensity, in a unit direction

  std::optional<Sun> distant_;
  Vec3 place_{0};
  Vec3 axis_{0};  // 0: all directions
  double least_cosine_ = -2;
  double exponent_ = 0;
  double radius_ = 0;
  bool disc_ = false;
  Vec3 intensity_{0};
};

// Lamps that are on, of each target of the world: the same ones in the same order.
using TraceLamps = std::vector<std::vector<TraceLamp>>;
TraceLamps trace_lamps(const world::World& world, const world::Camera& camera,
                       const trace::Scene& scene);

}  // namespace panwright::preview::reference
