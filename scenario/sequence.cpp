#include "scenario/sequence.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "base/text.h"

namespace panwright::scenario {

namespace {

// Times in both lists of spans.
std::vector<TimeSpan> intersection(const std::vector<TimeSpan>& a, const std::vector<TimeSpan>& b) {
  std::vector<TimeSpan> out;
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    const TimeSpan both{std::max(a[i].begin, b[k].begin), std::min(a[i].end, b[k].end)};
    if (both.begin <= both.end) out.push_back(both);
    (a[i].end < b[k].end ? i : k) += 1;
  }
  return out;
}

bool same_axes(const std::string& a, const std::string& b) {
  return a == b || (is_inertial_j2000(a) && is_inertial_j2000(b));
}

// Reports what keeps a source from the others. False: E8009.
bool fits(const SourceInfo& info, const SourceInfo& whole, DiagnosticLog& log) {
  const auto differ = [&](const char* what, const std::string& ours, const std::string& theirs) {
    log.report_file(Code("E8009"), info.name,
                    fmt::format("its {} is {}, that of the sources before is {}", what,
                                in_quotes(ours), in_quotes(theirs)),
                    "write all sources of a scenario in the same one");
    return false;
  };
  if (!info.frame.empty() && !whole.frame.empty() && !same_axes(info.frame, whole.frame))
    return differ("reference frame", info.frame, whole.frame);
  if (!info.centre.empty() && !whole.centre.empty() && info.centre != whole.centre)
    return differ("centre", info.centre, whole.centre);
  if (!info.frame.empty() && info.frame != whole.frame && !whole.frame.empty())
    log.report_file(Code("N8010"), info.name,
                    fmt::format("{} and {} are taken as the same axes; they differ by 0.02\"",
                                info.frame, whole.frame));
  return true;
}

}  // namespace

Result<Sequence> Sequence::of(std::vector<Part> parts, const SequenceOptions& options,
                              DiagnosticLog& log) {
  Sequence out;
  out.mount_ = options.mount;
  out.look_at_ = options.look_at;
  out.info_.spans = {TimeSpan{}};
  out.info_.epoch = options.epoch;
  bool with_system = options.system.has_value();
  out.info_.system = options.system.value_or(TimeSystem::utc);
  for (const Part& part : parts) {
    const SourceInfo& info = part.source->info();
    if (!info.epoch) continue;
    if (!with_system) out.info_.system = info.system;
    with_system = true;
    if (out.info_.epoch) continue;
    out.info_.epoch = info.epoch;
    if (std::ranges::any_of(parts, [](const Part& p) { return !p.source->info().epoch; }))
      log.report_file(
          Code("N8010"), info.name,
          fmt::format("time 0 of the scenario is taken as {} {}, its first epoch",
                      epoch_text(*info.epoch, info.system), time_system_name(info.system)));
  }
  bool sound = true;
  for (Part& part : parts) sound = out.add(std::move(part), log) && sound;
  const auto gives = [&](const Channel& channel) {
    return std::ranges::find(out.info_.channels, channel) != out.info_.channels.end();
  };
  const Channel camera_turn{Quantity::rotation, {}, {}};
  if (sound && options.look_at) {
    if (gives(camera_turn)) {
      log.report_file(Code("E8008"), {},
                      "the camera looks at a point, and a source gives its rotation as well");
      return failed;
    }
    if (!gives({Quantity::position, {}, {}})) {
      log.report_file(Code("E8009"), {}, "the camera looks at a point, and no source places it");
      return failed;
    }
    out.info_.channels.push_back(camera_turn);
  }
  for (const std::string& target : {options.look_at ? options.look_at->target : std::string(),
                                    options.mount ? options.mount->target : std::string()})
    if (sound && !target.empty() && !gives({Quantity::position, target, {}})) {
      log.report_file(
          Code("E8009"), {},
          "no source places target " + in_quotes(target) + ", which the camera follows");
      return failed;
    }
  if (!sound) return failed;
  return out;
}

bool Sequence::add(Part part, DiagnosticLog& log) {
  const SourceInfo& info = part.source->info();
  if (!fits(info, info_, log)) return false;
  if (info_.frame.empty()) info_.frame = info.frame;
  if (info_.centre.empty()) info_.centre = info.centre;
  for (const Channel& channel : info.channels) {
    for (const Shifted& before : parts_) {
      const auto& theirs = before.source->info();
      if (std::ranges::find(theirs.channels, channel) == theirs.channels.end()) continue;
      log.report_file(Code("E8008"), info.name,
                      channel_text(channel) + " is given by " + theirs.name + " as well");
      return false;
    }
    info_.channels.push_back(channel);
  }
  double offset = part.offset;
  if (info.epoch) {
    assert(info_.epoch);
    offset += seconds_between(*info_.epoch, *info.epoch);
    if (info.system != info_.system &&
        (info.system == TimeSystem::utc || info_.system == TimeSystem::utc) &&
        !leap_seconds_known(*info.epoch))
      log.report_file(Code("N8010"), info.name,
                      "TAI − UTC is assumed to stay at 37 s after 2026-06-30");
  }
  if (info.ordered > 0) {
    if (info_.ordered > 0 && info_.ordered != info.ordered) {
      log.report_file(Code("E8009"), info.name,
                      fmt::format("it has {}, and the sources before have {}; frames without "
                                  "times are combined one by one",
                                  counted(info.ordered, "frame"), counted(info_.ordered, "frame")));
      return false;
    }
    info_.ordered = info.ordered;
  } else {
    std::vector<TimeSpan> spans = info.spans;
    for (TimeSpan& span : spans) span = {span.begin + offset, span.end + offset};
    info_.spans = intersection(info_.spans, spans);
  }
  if (info_.times.empty() && !info.times.empty()) {
    leading_ = parts_.size();
    for (const double time : info.times) info_.times.push_back(time + offset);
  }
  parts_.push_back({std::move(part.source), offset});
  if (info_.ordered > 0 && std::ranges::any_of(parts_, [](const Shifted& p) {
        return p.source->info().ordered == 0 && !p.source->info().constant;
      })) {
    log.report_file(Code("E8009"), info.name,
                    "frames without times cannot be combined with a source over time",
                    "give the flight file a frame rate, or set_time lines");
    return false;
  }
  return true;
}

// A time that is the end of a span but for rounding of the offset is that end.
double Sequence::own_time(const Shifted& part, double time) {
  const double own = time - part.offset;
  const double slack =
      4 * std::numeric_limits<double>::epsilon() * (std::abs(time) + std::abs(part.offset));
  const std::vector<TimeSpan>& spans = part.source->info().spans;
  const auto after = std::ranges::upper_bound(spans, own, {}, &TimeSpan::begin);
  if (after != spans.end() && after->begin - own <= slack) return after->begin;
  if (after == spans.begin()) return own;
  const double end = std::prev(after)->end;
  if (own > end && own - end <= slack) return end;
  return own;
}

Result<Frame> Sequence::at(double time, DiagnosticLog& log) const {
  Frame frame;
  for (const Shifted& part : parts_)
    if (!part.source->at(own_time(part, time), frame, log)) return failed;
  frame.time = time;
  if (!finish(frame, log)) return failed;
  return frame;
}

Result<Frame> Sequence::frame(std::size_t index, DiagnosticLog& log) const {
  assert(index < frames());
  Frame frame;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Shifted& part = parts_[i];
    const bool own = part.source->info().ordered > 0 || (!ordered() && i == leading_);
    const bool filled =
        own ? part.source->frame(index, frame, log)
            : part.source->at(ordered() ? 0 : own_time(part, info_.times[index]), frame, log);
    if (!filled) return failed;
  }
  if (!ordered()) frame.time = info_.times[index];
  if (!finish(frame, log)) return failed;
  return frame;
}

bool Sequence::finish(Frame& frame, DiagnosticLog& log) const {
  frame.epoch = info_.epoch;
  frame.system = info_.system;
  if (mount_) {
    const TargetState* const target = frame.find(mount_->target);
    const world::Pose carrier = target ? target->placement.pose() : world::Pose{};
    const Quat turn = mount_->turns ? carrier.rotation : Quat(1, 0, 0, 0);
    if (frame.camera.position)
      frame.camera.position = carrier.translation + turn * *frame.camera.position;
    if (frame.camera.rotation) frame.camera.rotation = turn * *frame.camera.rotation;
  }
  if (look_at_) {
    Vec3 point = look_at_->point;
    if (const TargetState* const target = frame.find(look_at_->target)) {
      const world::Pose pose = target->placement.pose();
      point = pose.translation + pose.rotation * point;
    }
    const auto turn =
        world::looking_at(frame.camera.position.value_or(Vec3(0)), point, look_at_->up, log);
    if (!turn) return false;
    frame.camera.rotation = *turn;
  }
  return true;
}

}  // namespace panwright::scenario
