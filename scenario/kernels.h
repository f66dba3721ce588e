// Positions, attitudes and the Sun from SPICE kernels.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "ephemeris/kernels.h"
#include "scenario/source.h"

namespace panwright::scenario {

struct KernelOptions {
  std::string target;  // owner of the position and rotation; empty: the camera
  std::string body;  // owner of the position in the kernels, by name or number; empty: no position
  std::string observer;                 // in the origin
  std::string frame = "J2000";          // its axes
  std::string aberration = "none";      // of positions, as ephemeris::aberration_named()
  std::string attitude;                 // frame whose axes the model or camera has; empty: none
  bool sun = false;                     // its direction and distance, from the body or the origin
  std::optional<Epoch> epoch;           // of time 0; none: the first second that is covered
  TimeSystem system = TimeSystem::tdb;  // in which it is written
};

// Returns ET, seconds of TDB past J2000, of an epoch.
double et_of(const Epoch& epoch);
Epoch epoch_of(double et);

// Members of frames at the times that the kernels cover; kilometres become metres.
//
//   name  in diagnostics
// Fails: E8003 where they cover no time; E8009 where they hold at all times and no epoch is given;
// E8013 for names that no kernel has.
Result<SourcePtr> kernel_source(const std::string& name, ephemeris::Kernels kernels,
                                const KernelOptions& options, DiagnosticLog& log);

}  // namespace panwright::scenario
