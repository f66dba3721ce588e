#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/math.h"
#include "base/parallel.h"
#include "image/internal/writers.h"
#include "image/png.h"
#include "image/srgb.h"

namespace panwright::image {

namespace {

void append_big_endian(std::uint64_t value, std::string& out) {
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>((value >> shift) & 0xff);
}

// A tEXt chunk (PNG specification, 11.3.3.3).
std::string text_chunk(const std::string& name, const std::string& value) {
  const std::string body = "tEXt" + name + std::string(1, '\0') + value;
  std::string chunk;
  append_big_endian(body.size() - 4, chunk);
  chunk += body;
  append_big_endian(crc32_z(0, reinterpret_cast<const Bytef*>(body.data()), body.size()), chunk);
  return chunk;
}

// Scales a colour so that its largest channel follows a shoulder that ends at white, and mixes it
// with white the more it is over-exposed: the ratios of differences between channels, and so the
// hue, stay.
void photographed(std::array<double, 3>& color) {
  constexpr double kShoulder = 0.5;  // linear below
  constexpr double kFade = 3;  // over-exposure that takes 63 % of the colour, in parts of white
  const double largest = std::max({color[0], color[1], color[2]});
  if (!(largest > kShoulder)) return;
  const double beyond = (largest - kShoulder) / (1 - kShoulder);
  const double shown = std::isinf(largest) ? 1 : 1 - (1 - kShoulder) / (1 + beyond);
  const double white = largest > 1 ? 1 - std::exp((1 - largest) / kFade) : 0;
  for (double& channel : color) {
    const double ratio = std::isinf(largest) ? 1 : channel / largest;
    channel = shown * (ratio + (1 - ratio) * white);
  }
}

}  // namespace

std::vector<std::uint8_t> png_codes(const Image& image, const PngExposure& exposure) {
  const double scale = kPi * std::exp2(exposure.stops);
  std::vector<std::uint8_t> codes(image.radiance.size());
  const std::size_t row = std::size_t{3} * image.width;
  parallel_for(image.height, [&](std::size_t j) {
    for (std::size_t i = j * row; i < (j + 1) * row; i += 3) {
      std::array<double, 3> color{};
      for (std::size_t k = 0; k < 3; ++k) color[k] = scale * image.radiance[i + k];
      if (exposure.photo) photographed(color);
      for (std::size_t k = 0; k < 3; ++k) codes[i + k] = srgb_code(color[k]);
    }
  });
  return codes;
}

bool write_png(AtomicFile& file, const Image& image, const PngExposure& exposure,
               DiagnosticLog& log) {
  const std::vector<std::uint8_t> codes = png_codes(image, exposure);
  PngOptions options;
  options.channels = 3;
  options.says_srgb = true;
  return write_with_record(file, image, png_file(image.width, image.height, codes, options), log);
}

bool write_numbers_png(AtomicFile& file, const Image& image, DiagnosticLog& log) {
  PngOptions options;
  options.channels = 1;
  options.bytes = image.dn_bits > 8 ? 2 : 1;
  options.bits = image.dn_bits;
  std::vector<std::uint8_t> bytes;
  bytes.reserve(image.dn.size() * static_cast<std::size_t>(options.bytes));
  for (const std::uint16_t number : image.dn) {
    if (options.bytes == 2) bytes.push_back(static_cast<std::uint8_t>(number >> 8));
    bytes.push_back(static_cast<std::uint8_t>(number));
  }
  return write_with_record(file, image, png_file(image.width, image.height, bytes, options), log);
}

bool write_with_record(AtomicFile& file, const Image& image, const std::string& png,
                       DiagnosticLog& log) {
  // the signature and the first chunk, of fixed sizes; then what has no order
  constexpr std::size_t kHeader = 8 + 25;
  std::string head = png.substr(0, kHeader);
  for (const auto& [name, value] : image.metadata)
    if (name == kRecordName) head += text_chunk(name, value);
  return file.write(as_bytes(head), log) &&
         file.write(as_bytes(std::string_view(png).substr(kHeader)), log);
}

}  // namespace panwright::image
