// Orbit ephemeris messages of CCSDS (502.0-B, versions 1 to 3, keyword-value notation or
// XML).
#pragma once

#include <string>

#include "base/result.h"
#include "scenario/source.h"
#include "scenario/text.h"

namespace panwright::scenario {

struct OemOptions {
  std::string target;   // owner of the positions; empty: the camera
  bool strict = false;  // deviations are errors
};

// Reads positions over time: interpolated as the message says (Hermite of degree 7 where it does
// not: N8010), within a block, in its usable span. Its axes are REF_FRAME, its origin CENTER_NAME;
// kilometres become metres. Its own frames are at its records.
//
// Reports: W8011, W8012, N8010. Fails: E8001, E8004, E8007.
Result<SourcePtr> read_oem(const Text& text, const OemOptions& options, DiagnosticLog& log);

}  // namespace panwright::scenario
