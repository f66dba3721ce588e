// Labels of an image whose rows show a world at different times.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "labels/compute.h"
#include "labels/labels.h"

namespace panwright::labels {

// Sum of the labels of such an image, each of the rows of one time (FrameContext::rows).
//
// Masks, boxes and areas are joined. A keypoint is where its row shows it: places between two times
// are interpolated, `occluded` and `lit` are those of the nearer time. A keypoint that is in its
// row more than once is where it is first; one outside of the image is where the nearest row would
// show it. Poses are those of the frame.
class RollingLabels {
 public:
  // frame      labels of no rows at the frame's time: its poses, camera and Sun
  // line_time  seconds from the exposure of a row to that of the row below; negative: the lowest
  //            row is the first. Expects: not 0
  RollingLabels(FrameLabels frame, double line_time);

  // Adds the labels of some rows, seconds after the first row.
  //
  // Expects: the same things; ascending times; rows that no other time has.
  void add(FrameLabels&& labels, double seconds);

  FrameLabels take();

 private:
  struct Of {
    std::vector<Mask> amodal, visible;  // of all times
    std::vector<std::vector<Keypoint>> keypoints;
  };
  // Seconds from the exposure of a place to the time that is shown there; positive: it is over.
  double lateness(const Keypoint& keypoint, double seconds) const;
  Keypoint between(const Keypoint& before, const Keypoint& now, double share) const;
  Keypoint keypoint(const std::vector<std::vector<Keypoint>>& all, std::size_t number) const;

  FrameLabels frame_;
  double line_time_;
  std::vector<double> seconds_;
  std::vector<Of> of_;  // by thing
};

}  // namespace panwright::labels
