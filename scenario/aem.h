// Attitude ephemeris messages of CCSDS (504.0-B, versions 1 and 2, keyword-value notation or
// XML).
#pragma once

#include <string>

#include "base/result.h"
#include "scenario/source.h"
#include "scenario/text.h"

namespace panwright::scenario {

struct AemOptions {
  std::string target;   // owner of the attitude; empty: the camera
  bool strict = false;  // deviations are errors
};

// Reads attitudes over time as world_from_body, whichever of REF_FRAME_A and REF_FRAME_B is the
// body and whatever ATTITUDE_DIR is. The other one is the source's frame.
//
// Quaternions and Euler angles are read, with or without rates; blocks of spin are skipped (W8002).
// Between records attitudes turn evenly on the shorter way; LAGRANGE interpolates components. Other
// methods are a deviation, as rates are not used.
//
// Reports: W8002, W8006, W8011, W8012, N8010. Fails: E8001, E8004, E8005, E8007.
Result<SourcePtr> read_aem(const Text& text, const AemOptions& options, DiagnosticLog& log);

}  // namespace panwright::scenario
