// Sources of frames: some channels of a scenario over time, as one file or one formula gives them.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "scenario/frame.h"
#include "scenario/time.h"

namespace panwright::scenario {

enum class Quantity : std::uint8_t {
  position,
  rotation,
  joint,
  lens,
  sun_direction,
  sun_distance,
  name,
  seed,
};

// Returns whether axes are those of J2000 within 0.1": the mean equator of J2000, and the ICRF.
bool is_inertial_j2000(std::string_view frame);

// One member of a frame.
struct Channel {
  Quantity quantity = Quantity::position;
  std::string target;  // of a position, rotation or joint; empty: the camera's
  std::string joint;
  bool operator==(const Channel&) const = default;
};

// Returns "the position of 'client'"…
std::string channel_text(const Channel& channel);

// Closed interval of seconds.
struct TimeSpan {
  double begin = -std::numeric_limits<double>::infinity();
  double end = std::numeric_limits<double>::infinity();
  bool contains(double time) const { return time >= begin && time <= end; }
  bool operator==(const TimeSpan&) const = default;
};

struct SourceInfo {
  std::string name;                     // in diagnostics: of its file, or of its formula
  std::optional<Epoch> epoch;           // of time 0; none: its times have no date
  TimeSystem system = TimeSystem::utc;  // in which its epochs are written
  std::string frame;                    // its axes, as "EME2000"; empty: not stated
  std::string centre;                   // its origin, as "EARTH"; empty: not stated
  std::vector<Channel> channels;        // members it gives
  std::vector<TimeSpan> spans;  // times at which it does: ascending, disjoint but for end points
  std::vector<double> times;    // of its own frames, ascending; empty: no frames of its own
  std::size_t ordered = 0;      // frames of its own without times, by order alone
  bool constant = false;        // the same at all times
};

// A source never changes; any number of threads may read it.
class Source {
 public:
  virtual ~Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  const SourceInfo& info() const { return info_; }
  // Frames of its own.
  std::size_t frames() const { return info_.ordered ? info_.ordered : info_.times.size(); }

  // Writes its channels at a time into a frame; interpolates, and never beyond a span.
  //
  //   time  seconds since its epoch
  // False: E8003 outside its spans, or where its formula has no value; E8009 where its frames have
  // no times.
  bool at(double time, Frame& frame, DiagnosticLog& log) const;
  // Writes its channels in one of its own frames. False: E8003. Expects: index < frames().
  bool frame(std::size_t index, Frame& frame, DiagnosticLog& log) const;

 protected:
  explicit Source(SourceInfo info) : info_(std::move(info)) {}
  // Returns null, or the reason for which there is no frame. Expects: a time in a span.
  virtual const char* fill(double time, Frame& frame) const = 0;
  // One of its own frames without times.
  virtual void fill_ordered(std::size_t index, Frame& frame) const;

 private:
  bool filled(double time, Frame& frame, DiagnosticLog& log) const;
  SourceInfo info_;
};

using SourcePtr = std::shared_ptr<const Source>;

// Returns "0 s to 60 s (2026-01-01T00:00:00 to 2026-01-01T00:01:00 UTC)", the nearest first of
// several.
std::string spans_text(const SourceInfo& info, double time);
// Returns "12.5 s (2026-01-01T00:00:12.5 UTC)".
std::string time_text(const SourceInfo& info, double time);

}  // namespace panwright::scenario
