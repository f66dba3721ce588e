#include "labels/rolling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace panwright::labels {

namespace {

void join(const std::optional<Box>& other, std::optional<Box>& box) {
  if (!other) return;
  if (!box) {
    box = other;
    return;
  }
  box = Box{std::min(box->left, other->left), std::min(box->top, other->top),
            std::max(box->right, other->right), std::max(box->bottom, other->bottom)};
}

// Masks of rows that differ, as one.
Mask joined(const std::vector<Mask>& masks) {
  std::uint32_t left = std::numeric_limits<std::uint32_t>::max(), top = left, right = 0, bottom = 0;
  for (const Mask& mask : masks) {
    if (mask.width == 0) continue;
    left = std::min(left, mask.left);
    top = std::min(top, mask.top);
    right = std::max(right, mask.left + mask.width);
    bottom = std::max(bottom, mask.top + mask.height);
  }
  Mask out;
  if (right == 0) return out;
  out = {left, top, right - left, bottom - top, {}};
  out.coverage.resize(std::size_t{out.width} * out.height);
  for (const Mask& mask : masks)
    for (std::uint32_t row = 0; row < mask.height; ++row)
      std::copy_n(mask.coverage.begin() + static_cast<std::ptrdiff_t>(row) * mask.width, mask.width,
                  out.coverage.begin() +
                      static_cast<std::ptrdiff_t>(std::size_t{mask.top + row - top} * out.width +
                                                  (mask.left - left)));
  return out;
}

}  // namespace

RollingLabels::RollingLabels(FrameLabels frame, double line_time)
    : frame_(std::move(frame)), line_time_(line_time), of_(frame_.things.size()) {}

void RollingLabels::add(FrameLabels&& labels, double seconds) {
  seconds_.push_back(seconds);
  for (std::size_t t = 0; t < of_.size(); ++t) {
    Thing& from = labels.things[t];
    Thing& to = frame_.things[t];
    of_[t].amodal.push_back(std::move(from.amodal));
    of_[t].visible.push_back(std::move(from.visible));
    of_[t].keypoints.push_back(std::move(from.keypoints));
    join(from.amodal_box, to.amodal_box);
    join(from.visible_box, to.visible_box);
    to.amodal_pixels += from.amodal_pixels;
    to.visible_pixels += from.visible_pixels;
  }
}

double RollingLabels::lateness(const Keypoint& keypoint, double seconds) const {
  const double row = keypoint.pixel->y - 0.5;
  const double rows = line_time_ > 0 ? row : frame_.camera.height - 1 - row;
  return seconds - rows * std::fabs(line_time_);
}

Keypoint RollingLabels::between(const Keypoint& before, const Keypoint& now, double share) const {
  Keypoint out = share < 0.5 ? before : now;
  out.position = glm::mix(before.position, now.position, share);
  out.in_camera = glm::mix(before.in_camera, now.in_camera, share);
  out.pixel = glm::mix(*before.pixel, *now.pixel, share);
  const Vec2& at = *out.pixel;
  out.truncated =
      !(at.x >= 0 && at.y >= 0 && at.x < frame_.camera.width && at.y < frame_.camera.height);
  return out;
}

Keypoint RollingLabels::keypoint(const std::vector<std::vector<Keypoint>>& all,
                                 std::size_t number) const {
  const Keypoint* before = nullptr;
  const Keypoint* over = nullptr;  // by the first time already
  double late = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Keypoint& now = all[k][number];
    if (!now.pixel) {
      before = nullptr;
      continue;
    }
    const double later = lateness(now, seconds_[k]);
    if (before != nullptr && (later >= 0) != (late >= 0))
      return between(*before, now, late / (late - later));
    if (before == nullptr && later >= 0) {
      if (!now.truncated) return now;
      over = over != nullptr ? over : &now;
    }
    before = &now;
    late = later;
  }
  if (over != nullptr) return *over;
  return before != nullptr ? *before : all.back()[number];
}

FrameLabels RollingLabels::take() {
  for (std::size_t t = 0; t < of_.size(); ++t) {
    Thing& thing = frame_.things[t];
    thing.amodal = joined(of_[t].amodal);
    thing.visible = joined(of_[t].visible);
    // sums of one order of magnitude may differ by rounding
    thing.visible_pixels = std::min(thing.visible_pixels, thing.amodal_pixels);
    for (std::size_t k = 0; !seconds_.empty() && k < thing.keypoints.size(); ++k)
      thing.keypoints[k] = keypoint(of_[t].keypoints, k);
  }
  return std::move(frame_);
}

}  // namespace panwright::labels
