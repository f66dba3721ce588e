// Plain-text outputs of the simulators 42 and Basilisk.
//
// Sources: 42 (ericstoneking/42): time.42, PosN.42, PosR.42, qbn.42; Basilisk (AVSLab/basilisk):
// messages r_BN_N and sigma_BN of recorders, written as a table.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "scenario/source.h"
#include "scenario/text.h"

namespace panwright::scenario {

// Files of 42, one line a step.
struct FortyTwoTexts {
  Text time;                     // seconds
  std::optional<Text> position;  // x y z, metres; 7 digits, so that positions of orbits are rough
  std::optional<Text> rotation;  // qbn: x y z w
  std::string target;            // empty: the camera
};

// Fails: E8001 (also where files have different numbers of lines), E8004, E8005. Reports: W8006,
// W8011; W8012 where positions are rounded to more than 1 mm.
Result<SourcePtr> read_42(const FortyTwoTexts& texts, DiagnosticLog& log);

// Reads a table of Basilisk. Its first line, after a # or not, names the columns: time[s] or
// time[ns] (a time without unit: nanoseconds, N8010), r_BN_N[0] to [2] (metres) and sigma_BN[0] to
// [2] (modified Rodrigues parameters, either set); also with _0, _1, _2 or _x, _y, _z behind the
// names. Other columns are skipped (W8002).
//
//   target  empty: the camera
// Reports: N8010, W8002, W8011. Fails: E8001, E8004, E8005.
Result<SourcePtr> read_basilisk(const Text& text, const std::string& target, DiagnosticLog& log);

}  // namespace panwright::scenario
