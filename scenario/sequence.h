// Sequence of frames, combined from sources: poses from one, attitudes from another, the camera
// from a third.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "scenario/source.h"

namespace panwright::scenario {

struct Part {
  SourcePtr source;
  double offset = 0;  // seconds by which its times move; without a date after the scenario's epoch
};

// Camera that turns towards a point: its rotation follows from its position.
struct LookAt {
  std::string target;      // empty: the point is in world axes
  Vec3 point{0};           // metres; of a target: in its model's axes
  std::optional<Vec3> up;  // as world::looking_at
};

// Target that carries the camera: camera positions and rotations of sources are relative to it.
struct Mount {
  std::string target;
  bool turns = false;  // true: in the model's axes; false: along world axes from its origin
};

struct SequenceOptions {
  std::optional<Epoch> epoch;        // of time 0; none: that of the first source with one
  std::optional<TimeSystem> system;  // none: of that source
  std::optional<Mount> mount;
  std::optional<LookAt> look_at;
};

class Sequence {
 public:
  // Reports: N8010 for an epoch taken from a source, and for leap seconds assumed. Fails: E8008
  // where two sources give one member, E8009 where sources cannot be combined.
  static Result<Sequence> of(std::vector<Part> parts, const SequenceOptions& options,
                             DiagnosticLog& log);

  const std::optional<Epoch>& epoch() const { return info_.epoch; }
  TimeSystem system() const { return info_.system; }
  // Axes and origin of its positions, of the sources that state them; empty: none does.
  const std::string& axes() const { return info_.frame; }
  const std::string& centre() const { return info_.centre; }
  // Members of its frames.
  const std::vector<Channel>& channels() const { return info_.channels; }
  // Times that all sources cover, ascending.
  const std::vector<TimeSpan>& spans() const { return info_.spans; }
  // Times of the frames of its first source with frames of its own; empty: none has, or
  // ordered().
  const std::vector<double>& times() const { return info_.times; }
  // True: frames have an order and no times.
  bool ordered() const { return info_.ordered > 0; }
  std::size_t frames() const { return ordered() ? info_.ordered : info_.times.size(); }

  // Returns the frame of a time, seconds since the epoch. Fails: E8003, E8009; E0201 where the
  // camera stands on the point that it looks at.
  Result<Frame> at(double time, DiagnosticLog& log) const;
  // Returns a frame by its order. Fails: as at(). Expects: index < frames().
  Result<Frame> frame(std::size_t index, DiagnosticLog& log) const;

 private:
  struct Shifted {
    SourcePtr source;
    double offset = 0;
  };
  static double own_time(const Shifted& part, double time);
  bool add(Part part, DiagnosticLog& log);
  bool finish(Frame& frame, DiagnosticLog& log) const;

  SourceInfo info_;
  std::vector<Shifted> parts_;
  std::size_t leading_ = 0;  // index of the part with the frames
  std::optional<Mount> mount_;
  std::optional<LookAt> look_at_;
};

}  // namespace panwright::scenario
