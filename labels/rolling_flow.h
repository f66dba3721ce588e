// Optical flow of images whose rows show a world at different times.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "base/job.h"
#include "image/image.h"
#include "labels/flow.h"
#include "labels/labels.h"
#include "world/camera.h"

namespace panwright::labels {

// Places of points in such an image: each where its own row shows it, between two times by
// interpolation, as keypoints (labels/rolling.h). One that no row shows is where the nearest one
// would.
class RollingPlaces {
 public:
  // camera     its lens and size; outlives this
  // line_time  seconds from the exposure of a row to that of the row below it; negative: the lowest
  //            row is the first. 0: one time
  RollingPlaces(const world::Camera& camera, double line_time);
  ~RollingPlaces();
  RollingPlaces(RollingPlaces&&) noexcept;
  RollingPlaces& operator=(RollingPlaces&&) noexcept;

  // Adds the world at some seconds after the first row.
  //
  // Expects: ascending times; the same targets; a camera with that lens.
  void add(const Moment& moment, double seconds);

  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

// Returns the flow of an image into another one of the same targets.
//
//   moment_of_row  of `now`: number of the moment that a row shows
//   layers         image of `now`, with ground truth of these moments
// Throws Cancelled.
Flow flow_of_rows(const RollingPlaces& now, const RollingPlaces& other,
                  std::span<const std::uint32_t> moment_of_row, const image::Image& layers,
                  const Job& job = {});

}  // namespace panwright::labels
