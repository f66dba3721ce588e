#include "image/shown.h"

#include <string_view>
#include <vector>

#include "image/internal/image_codecs.h"
#include "image/srgb.h"

namespace panwright::image {

unsigned bits_of_numbers(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with(kPngSignature) || text.size() < kPngHeaderEnd) return 0;
  const auto byte = [&](std::size_t at) { return std::to_integer<unsigned>(bytes[at]); };
  const unsigned depth = byte(24), color = byte(25), interlacing = byte(28);
  if (color != 0 || interlacing != 0 || (depth != 8 && depth != 16)) return 0;
  for (std::size_t at = kPngHeaderEnd; at + 12 < text.size();) {
    const std::string_view name = text.substr(at + 4, 4);
    if (name == "sBIT") return byte(at + 8) <= depth ? byte(at + 8) : 0;
    if (name == "IDAT") return 0;
    at += std::size_t{12} + big_endian(bytes, at);
  }
  return 0;
}

ImageProblem decode_shown(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                          DecodedImage& out) {
  const unsigned bits = bits_of_numbers(bytes);
  if (bits == 0) return decode_image(bytes, max_bytes, out);
  std::vector<std::uint8_t> codes(std::size_t{1} << bits);
  const auto most = static_cast<double>(codes.size() - 1);
  for (std::size_t k = 0; k < codes.size(); ++k)
    codes[k] = srgb_code(static_cast<double>(k) / most);
  return decode_numbers_png(bytes, max_bytes, codes, out);
}

}  // namespace panwright::image
