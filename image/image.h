// Images of linear radiance with their ground truth layers, and their files (docs/conventions.md 4
// and 8). Nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "image/srgb.h"

namespace panwright::image {

// Metadata name of the record of an image's making (workspace/record.h).
inline constexpr const char* kRecordName = "panwright.record";

// One rendered view. Row 0 is the top row; all layers run along rows. H = height, W = width.
// Radiance and coverage are means over the pixel, radiance premultiplied by coverage; the truth
// layers are point values at the pixel's centre and all present or all empty.
struct Image {
  std::uint32_t width = 0;   // pixels
  std::uint32_t height = 0;  // pixels
  std::string unit;          // of radiance: "1/sr" or "W/(m^2 sr)"

  std::vector<float> radiance;  // 3*H*W
  std::vector<float> coverage;  // H*W, 0 to 1

  std::vector<float> depth;                // H*W metres along the boresight; background +inf
  std::vector<float> range;                // H*W metres from the camera; background +inf
  std::vector<float> normal;               // 3*H*W unit, world, as shaded; background 0 0 0
  std::vector<std::uint32_t> target_id;    // H*W index in the world + 1; background 0
  std::vector<std::uint32_t> node_id;      // H*W index of the node in its target's model + 1; or 0
  std::vector<std::uint32_t> material_id;  // H*W material index there + 1; background 0

  std::vector<float> standard_error;  // 3*H*W of the radiance; empty if unknown

  // Of a camera with a detector; else empty.
  std::vector<std::uint16_t> dn;  // H*W digital numbers
  unsigned dn_bits = 0;           // 2 to 16
  std::string filters;            // of its pixels, as "rggb"; empty: mono
  std::vector<float> electrons;   // H*W charge before the read noise
  // H*W electrons, by stage of the detector: what it added.
  std::vector<std::pair<std::string, std::vector<float>>> stages;

  // Name and value, for EXR headers; that of kRecordName also for PNG (a text chunk of ASCII) and
  // .npz (meta.json). Not in .npy.
  std::vector<std::pair<std::string, std::string>> metadata;

  bool has_ground_truth() const { return !depth.empty(); }
  std::size_t pixels() const { return std::size_t{width} * height; }
};

// Sets the layers of ground truth to the background, or, if not wanted, to none.
void reset_ground_truth(Image& image, bool wanted = true);

enum class ImageFormat {
  png,  // 8 bits a channel, sRGB(clamp(π·L·2^EV)): a white Lambert plate at normal Sun is white;
        // of a detector its numbers, 8 or 16 bits
  exr,  // R G B A Z range N.X N.Y N.Z error.R error.G error.B float,
        // id.target id.node id.material uint
  tiff,  // digital numbers, 8 or 16 bits
  fits,  // digital numbers, 8 or 16 bits
  npy,   // (H, W, 3) float32 radiance
  npz,   // radiance, coverage; depth, range, normal, target_id, node_id, material_id;
         // standard_error; dn, electrons, stages; meta.json first
};

// Returns the format of a file name's extension, in any letter case.
std::optional<ImageFormat> image_format(const std::filesystem::path& path);

enum class FileLayer : std::uint8_t {
  radiance,
  coverage,
  depth,
  range,
  normal,
  target_id,
  node_id,
  material_id,
  standard_error,
  dn,
  electrons,
  stages,
};

// Names of layers, by FileLayer: those of .npz files.
inline constexpr std::string_view kLayerNames[] = {
    "radiance", "coverage",    "depth",          "range", "normal",    "target_id",
    "node_id",  "material_id", "standard_error", "dn",    "electrons", "stages"};

// Choices for .exr and .npz files.
struct FileOptions {
  // 1 << FileLayer: those to write, where the image has them. Stages are of interest alone.
  std::uint32_t layers = ~(1u << static_cast<unsigned>(FileLayer::stages));
  bool compress = false;  // .npz: deflate the layers
  bool has(FileLayer layer) const { return (layers >> static_cast<unsigned>(layer) & 1u) != 0; }
};

// Returns true if a file holds ground truth layers; otherwise they need not be rendered.
bool stores_ground_truth(ImageFormat format, const FileOptions& options = {});

// Exposure and tone curve of a PNG.
struct PngExposure {
  PngExposure(double in_stops, bool as_photo = false) : stops(in_stops), photo(as_photo) {}
  double stops = 0;  // white is 2^-stops / pi of the irradiance
  // false: linear up to white, each channel clipped. true: brightness above 0.5 of white is
  // compressed and bright colours fade to white as in photographs; hue stays. For viewing, not for
  // measuring.
  bool photo = false;
};

// Writes an image in the format of its extension, atomically. Absent layers are left out. The bytes
// depend on the image, the exposure and the options alone.
//
//   exposure      of a PNG
//   sync_seconds  the time spent in fsync is added to it when given
//
// Expects: radiance and coverage of the size; ground truth layers of the size, or empty; digital
// numbers for .tif and .fits.
// Fails: E0202 for another extension; E0103.
bool write_image(const std::filesystem::path& path, const Image& image, const PngExposure& exposure,
                 DiagnosticLog& log, double* sync_seconds = nullptr,
                 const FileOptions& options = {});

// Reads the metadata of kRecordName from a file that write_image() wrote.
//
// Fails: E0101, E0102; E0202 for another extension; E0207 without one.
Result<std::string> read_image_record(const std::filesystem::path& path, DiagnosticLog& log);

}  // namespace panwright::image
