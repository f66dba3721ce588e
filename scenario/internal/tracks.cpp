#include "scenario/internal/tracks.h"

#include <algorithm>
#include <utility>

namespace panwright::scenario {

namespace {

// A channel's values at a time, or of a frame by its order.
class TrackSource final : public Source {
 public:
  TrackSource(SourceInfo info, Tracks tracks)
      : Source(std::move(info)), names_(std::move(tracks.names)), seeds_(std::move(tracks.seeds)) {
    const auto samples = [&]<class Value>(std::vector<Value>& values) {
      return Samples<Value>{tracks.times, std::move(values), {}, tracks.method, tracks.degree, {}};
    };
    for (PositionTrack& each : tracks.positions) {
      positions_.push_back({std::move(each.target), samples(each.values)});
      positions_.back().second.velocities = std::move(each.velocities);
    }
    for (RotationTrack& each : tracks.rotations)
      rotations_.push_back({std::move(each.target), samples(each.values)});
    for (JointTrack& each : tracks.joints) {
      joints_.push_back(
          {std::move(each.target), std::move(each.joint), each.component, samples(each.values)});
    }
    for (LensTrack& each : tracks.lens) lens_.push_back({each.number, samples(each.values)});
    sun_directions_ = samples(tracks.sun_directions);
    sun_distances_ = samples(tracks.sun_distances);
  }

 private:
  struct JointSamples {
    std::string target;
    std::string joint;
    std::size_t component = 0;
    Samples<double> samples;
  };

  // at: gives the value of samples
  template <class At>
  void fill_with(const At& at, Frame& frame) const {
    for (const auto& [target, samples] : positions_) {
      Placement& placement = target.empty() ? frame.camera : frame.target(target).placement;
      placement.position = at(samples);
    }
    for (const auto& [target, samples] : rotations_) {
      Placement& placement = target.empty() ? frame.camera : frame.target(target).placement;
      placement.rotation = at(samples);
    }
    for (const JointSamples& each : joints_) {
      JointValue& joint = frame.joint(each.target, each.joint);
      joint.values[each.component] = at(each.samples);
      joint.count = std::max(joint.count, each.component + 1);
    }
    for (const auto& [number, samples] : lens_) set(frame.lens, number, at(samples));
    if (!sun_directions_.values.empty()) {
      const Vec3 direction = at(sun_directions_);
      const double length = glm::length(direction);
      frame.sun_direction = length > 0 ? direction / length : sun_directions_.values[0];
    }
    if (!sun_distances_.values.empty()) frame.sun_distance = at(sun_distances_);
  }

  static void set(Lens& lens, LensNumber number, double value) {
    const auto component = [&](std::optional<Vec2>& vector) -> Vec2& {
      if (!vector) vector = Vec2(0);
      return *vector;
    };
    if (number == LensNumber::fov) lens.fov = value;
    if (number == LensNumber::focal_x) component(lens.focal).x = value;
    if (number == LensNumber::focal_y) component(lens.focal).y = value;
    if (number == LensNumber::principal_x) component(lens.principal).x = value;
    if (number == LensNumber::principal_y) component(lens.principal).y = value;
  }

  void set_own(std::size_t index, Frame& frame) const {
    if (!names_.empty()) frame.name = names_[index];
    if (!seeds_.empty()) frame.seed = seeds_[index];
  }

  const char* fill(double time, Frame& frame) const override {
    fill_with([&](const auto& samples) { return value_at(samples, time); }, frame);
    const auto own = std::ranges::lower_bound(info().times, time);
    if (own != info().times.end() && *own == time)
      set_own(static_cast<std::size_t>(own - info().times.begin()), frame);
    return nullptr;
  }

  void fill_ordered(std::size_t index, Frame& frame) const override {
    fill_with([&](const auto& samples) { return samples.values[index]; }, frame);
    set_own(index, frame);
  }

  std::vector<std::pair<std::string, Samples<Vec3>>> positions_;
  std::vector<std::pair<std::string, Samples<Quat>>> rotations_;
  std::vector<JointSamples> joints_;
  std::vector<std::pair<LensNumber, Samples<double>>> lens_;
  Samples<Vec3> sun_directions_;
  Samples<double> sun_distances_;
  std::vector<std::string> names_;
  std::vector<std::uint64_t> seeds_;
};

}  // namespace

SourcePtr track_source(SourceInfo info, Tracks tracks) {
  info.channels.clear();
  const auto add = [&](Channel channel) {
    if (std::ranges::find(info.channels, channel) == info.channels.end())
      info.channels.push_back(std::move(channel));
  };
  for (const auto& each : tracks.positions) add({Quantity::position, each.target, {}});
  for (const auto& each : tracks.rotations) add({Quantity::rotation, each.target, {}});
  for (const auto& each : tracks.joints) add({Quantity::joint, each.target, each.joint});
  if (!tracks.lens.empty()) add({Quantity::lens, {}, {}});
  if (!tracks.sun_directions.empty()) add({Quantity::sun_direction, {}, {}});
  if (!tracks.sun_distances.empty()) add({Quantity::sun_distance, {}, {}});
  if (!tracks.names.empty()) add({Quantity::name, {}, {}});
  if (!tracks.seeds.empty()) add({Quantity::seed, {}, {}});
  if (tracks.times.empty()) {
    info.ordered = tracks.frames;
  } else {
    info.times = tracks.times;
    info.spans = {{tracks.times.front(), tracks.times.back()}};
  }
  return std::make_shared<TrackSource>(std::move(info), std::move(tracks));
}

}  // namespace panwright::scenario
