// Decoder of PPM, PNG and JPEG images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"

namespace panwright::image {

inline constexpr std::uint32_t kMaxTextureSide = 16384;  // pixels, as in the pan file

struct DecodedImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgba;  // 4·width·height, row 0 the top row
};

struct ImageProblem {
  std::optional<Code> code;  // none: success
  std::string message;
};

// Decodes an image, at most max_bytes of pixels (four bytes each). The format follows from the
// first bytes. Sizes are checked before anything is allocated. PNG checksums are verified; 16-bit
// channels keep their upper half. JPEG files with lost pixels are refused. Same bytes, same pixels,
// on any processor. Nothing is printed, and settings of libpng and libjpeg stay as they are.
//
// Problems: E3001 with the place in the file, E3002. Cost: O(bytes + pixels); JPEG: for each scan.
ImageProblem decode_image(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                          DecodedImage& out);

// Place of an image on a planet, degrees.
struct Extent {
  double west = -180, north = 90, width = 360, height = 180;
};

struct ImageHead {
  std::uint32_t width = 0, height = 0;
  std::optional<Extent> extent;         // of GeoTIFF files in longitude and latitude
  std::optional<std::uint8_t> no_data;  // value of pixels without any, in all channels
};

// Receiver of the rows of an image, from the top.
class RowReceiver {
 public:
  virtual ~RowReceiver() = default;
  // Returns the problem if the image is not wanted.
  virtual ImageProblem begin(const ImageHead& head) = 0;
  virtual void row(std::span<const std::uint8_t> rgba) = 0;  // 4·width; throws nothing
};

inline constexpr std::uint32_t kMaxRowSide = 1u << 17;  // pixels

// Decodes an image row by row, in memory of some rows: PNG without interlacing, baseline JPEG, and
// TIFF by strips or tiles (grey, RGB and palettes of up to 16 bits; GeoTIFF). Others as
// decode_image(). After a problem rows may be missing.
//
// Problems: as decode_image(), and those of begin().
ImageProblem decode_rows(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                         RowReceiver& to);

// Judges an image in the place of a normal map: colours stand for unit vectors out of the surface.
// Returns the problem if most of its texels are something else, as in a colour image. Texels of
// alpha 0 are not used.
std::optional<std::string> normal_map_problem(std::span<const std::uint8_t> rgba);

}  // namespace panwright::image
