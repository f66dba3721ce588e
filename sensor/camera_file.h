// Camera files: image size and lens, as text of this program and of calibration programs.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "base/result.h"
#include "sensor/imager.h"
#include "sensor/lens.h"

namespace panwright::sensor {

// Pixels of places on the image plane: focal·place + principal, from the upper left corner of the
// image; pixel (i, j) covers [i, i+1) × [j, j+1) (docs/conventions.md).
struct Lens {
  Vec2 focal{1024};     // pixels, > 0
  Vec2 principal{512};  // pixels
  Distortion distortion;
  bool operator==(const Lens&) const = default;
};

inline constexpr std::uint32_t kMostPixels = 16384;  // of a side

struct CameraFile {
  std::string name;                // may be empty
  std::uint32_t width = 0;         // pixels, 1 to kMostPixels
  std::uint32_t height = 0;        // pixels, 1 to kMostPixels
  Lens lens;                       // of these pixels
  std::optional<Vec2> pixel_um{};  // sides of a pixel, µm, > 0; none: not known
  // Orthographic, in place of a lens: metres across the image, whose pixels are square and whose
  // principal point is its middle; `lens.focal` is in pixels per metre. 0: perspective.
  double width_m = 0;
  std::optional<Imager> imager{};      // of [detector] and [optics]
  Quat mount_from_camera{1, 0, 0, 0};  // unit: misalignment, from the attitude that views give
};

// Part of a detector, in pixels, read out in blocks.
struct Window {
  std::array<std::uint32_t, 4> region{};  // x, y, width, height; of size 0: all
  std::array<std::uint32_t, 2> binning{1, 1};
};

// Returns the camera of a window: rays stay, pixels are renumbered. Pixels that do not fill a block
// are left out. Nothing: the window lies outside, or is smaller than a block.
std::optional<CameraFile> windowed(const CameraFile& camera, const Window& window);

enum class CameraFormat {
  toml,    // our own: docs/cameras.md
  opencv,  // FileStorage of OpenCV: camera_matrix, distortion_coefficients, image_width
  ros,     // sensor_msgs/CameraInfo as YAML
  kalibr,  // camchain: its first camera
  speed,   // camera.json of SPEED and SPEED+
};

// Reads a camera, of the format that its content has. Principal points are converted from the
// centres of pixels to their corners: 0.5 more, except of our own format.
//
//   name  of the text in diagnostics
// Fails: E0220. Reports: W0221 for members that have no effect.
Result<CameraFile> read_camera(std::string_view text, const std::string& name, DiagnosticLog& log);

// Returns the text of a camera, which reads back as the same numbers to their last bit or two.
//
// Fails: E0220 for a lens that the format cannot hold.
Result<std::string> camera_text(const CameraFile& camera, CameraFormat format, DiagnosticLog& log);

// Returns a distortion as a model and its numbers, as "brown -0.2 0.1 0 0", which reads back to the
// same bits; empty: none. Numbers: those of Brown up to its last; 4 of fisheye; 1 of division; 5 of
// powers; of cahvore the axis, r, e and linearity.
std::string distortion_text(const Distortion& distortion);
// Reads it; nothing: a text of another form.
std::optional<Distortion> parse_distortion(std::string_view text);

}  // namespace panwright::sensor
