// Sources from texts in memory, for tests of scenario.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "base/diagnostic.h"
#include "base/math.h"
#include "scenario/sequence.h"
#include "scenario/source.h"
#include "scenario/text.h"

namespace panwright::scenario::support {

// Codes of a log in order, as "E8001 W8012".
inline std::string codes(const DiagnosticLog& log) {
  std::string out;
  for (const Diagnostic& entry : log.entries())
    out += (out.empty() ? "" : " ") + std::string(code_info(entry.code).name);
  return out;
}

// The line of the first entry with a place; 0: none.
inline std::uint32_t first_line(const DiagnosticLog& log) {
  for (const Diagnostic& entry : log.entries())
    if (entry.where.file != kNoFile)
      return log.sources().position(entry.where.file, entry.where.begin).line;
  return 0;
}

// The frame of a source at a time.
inline Frame at(const Source& source, double time) {
  Frame frame;
  DiagnosticLog log;
  EXPECT_TRUE(source.at(time, frame, log)) << to_text(log);
  return frame;
}

// The angle between two rotations, radians: from the chord, exact near 0.
inline double turn_between(const Quat& a, const Quat& b) {
  const auto chord = [](const Quat& x, const Quat& y) {
    const double d[] = {x.w - y.w, x.x - y.x, x.y - y.y, x.z - y.z};
    return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + d[3] * d[3]);
  };
  return 2 * std::min(chord(a, b), chord(a, -b));
}

}  // namespace panwright::scenario::support
