// Optics and detector of a camera file: its tables [optics] and [detector].
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/config_text.h"
#include "base/diagnostic.h"
#include "base/result.h"
#include "sensor/detector.h"
#include "sensor/optics.h"

namespace panwright::sensor {

struct Imager {
  Optics optics;
  Detector detector;
  bool auto_exposure = false;  // its exposure time is chosen by the image
  bool operator==(const Imager&) const = default;
};

// Reads the pixels of an imager in blocks: lengths of its optics become those of blocks.
void bin(Imager& imager, std::uint32_t side);

// Lens that f-numbers and focus refer to.
struct ImagerLens {
  double focal_px = 0;
  std::optional<Vec2> pixel_um;  // of the camera's own table
};

// Reads the tables. `optics` may be null. docs/detector.md.
//
// Fails: E0220. Reports: W0222 for values that belong to no real detector, or that lose much.
Result<Imager> read_imager(const ConfigValue& detector, const ConfigValue* optics,
                           const ImagerLens& lens, DiagnosticLog& log);

// Returns why a camera of this size cannot take its exposure; empty: it can.
std::string check_imager(const Imager& imager, std::uint32_t width, std::uint32_t height);

// Returns the tables as text, which reads back to the same numbers.
std::string imager_text(const Imager& imager);
// Reads that text. Fails: E0220.
Result<Imager> parse_imager(std::string_view text, DiagnosticLog& log);

}  // namespace panwright::sensor
