#include "scenario/source.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/text.h"

namespace panwright::scenario {

namespace {

constexpr double kMostSeconds = 1e11;  // epochs of four-digit years

std::string date_text(const SourceInfo& info, double time) {
  if (!info.epoch || !(std::abs(time) < kMostSeconds)) return {};
  return epoch_text(later(*info.epoch, time), info.system);
}

double distance(const TimeSpan& span, double time) {
  return std::max({span.begin - time, time - span.end, 0.0});
}

std::string span_text(const SourceInfo& info, const TimeSpan& span) {
  std::string out = fmt::format("{} s to {} s", span.begin, span.end);
  const std::string begin = date_text(info, span.begin), end = date_text(info, span.end);
  if (!begin.empty() && !end.empty())
    out += fmt::format(" ({} to {} {})", begin, end, time_system_name(info.system));
  return out;
}

}  // namespace

bool is_inertial_j2000(std::string_view frame) {
  return frame.starts_with("ICRF") || frame.starts_with("GCRF") || frame == "EME2000" ||
         frame == "J2000";
}

std::string channel_text(const Channel& channel) {
  const std::string whose =
      channel.target.empty() ? "the camera" : "target " + in_quotes(channel.target);
  switch (channel.quantity) {
    case Quantity::position:
      return "the position of " + whose;
    case Quantity::rotation:
      return "the rotation of " + whose;
    case Quantity::joint:
      return "joint " + in_quotes(channel.joint) + " of " + whose;
    case Quantity::lens:
      return "the lens";
    case Quantity::sun_direction:
      return "the direction of the Sun";
    case Quantity::sun_distance:
      return "the distance of the Sun";
    case Quantity::name:
      return "the name of the frame";
    case Quantity::seed:
      return "the seed";
  }
  return {};
}

std::string time_text(const SourceInfo& info, double time) {
  std::string out = fmt::format("{} s", time);
  const std::string date = date_text(info, time);
  if (!date.empty()) out += fmt::format(" ({} {})", date, time_system_name(info.system));
  return out;
}

std::string spans_text(const SourceInfo& info, double time) {
  if (info.spans.empty()) return "no time";
  const auto nearest = std::ranges::min_element(
      info.spans, {}, [&](const TimeSpan& span) { return distance(span, time); });
  std::string out = span_text(info, *nearest);
  if (info.spans.size() > 1) {
    const std::size_t others = info.spans.size() - 1;
    out += fmt::format(", and {} more span{}", others, others == 1 ? "" : "s");
  }
  return out;
}

bool Source::at(double time, Frame& frame, DiagnosticLog& log) const {
  if (info_.ordered > 0) {
    log.report_file(Code("E8009"), info_.name,
                    "its frames have an order and no times, so that it has no frame at " +
                        fmt::format("{} s", time));
    return false;
  }
  // the last span that begins by then
  const auto next =
      std::ranges::upper_bound(info_.spans, time, {}, [](const TimeSpan& s) { return s.begin; });
  if (next == info_.spans.begin() || !std::prev(next)->contains(time)) {
    log.report_file(
        Code("E8003"), info_.name,
        "no frame at " + time_text(info_, time) + "; it covers " + spans_text(info_, time));
    return false;
  }
  return filled(time, frame, log);
}

bool Source::filled(double time, Frame& frame, DiagnosticLog& log) const {
  const char* const problem = fill(time, frame);
  if (problem == nullptr) return true;
  log.report_file(Code("E8003"), info_.name,
                  "no frame at " + time_text(info_, time) + ": " + problem);
  return false;
}

bool Source::frame(std::size_t index, Frame& frame, DiagnosticLog& log) const {
  assert(index < frames());
  if (info_.ordered == 0) return filled(info_.times[index], frame, log);
  fill_ordered(index, frame);
  return true;
}

void Source::fill_ordered(std::size_t, Frame&) const {}

}  // namespace panwright::scenario
