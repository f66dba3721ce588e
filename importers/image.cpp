#include "importers/image.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

#include "base/text.h"

// note: its assertions are about the file, and would end the program
#define STBI_ASSERT(condition) static_cast<void>(0)
// note: zeroed memory, so that what a damaged file leaves unwritten is the same each time; and no
// vector code paths, so that the pixels are the same on each processor
#define STBI_MALLOC(size) std::calloc(1, size)
#define STBI_REALLOC(pointer, size) std::realloc(pointer, size)
#define STBI_FREE(pointer) std::free(pointer)
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_NO_SIMD
#define STBI_MAX_DIMENSIONS 16384
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wshadow"
#include <stb_image.h>
#pragma GCC diagnostic pop

namespace panwright::importers {

static_assert(STBI_MAX_DIMENSIONS == kMaxTextureSide);

namespace {

constexpr std::string_view kPngMark("\x89PNG\r\n\x1a\n", 8);
// deflate makes at most so many bytes of one
constexpr std::uint64_t kDeflateRatio = 1032;

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Whether the size may be decoded.
ImageProblem check_size(std::uint64_t width, std::uint64_t height, std::uint64_t max_bytes) {
  if (width == 0 || height == 0)
    return {Code::E3001, fmt::format("the image is {} x {} pixels", width, height)};
  if (width > kMaxTextureSide || height > kMaxTextureSide)
    return {Code::E3002, fmt::format("the image is {} x {} pixels; up to {} a side are read", width,
                                     height, kMaxTextureSide)};
  if (4 * width * height > max_bytes)
    return {Code::E3002, fmt::format("with {} x {} pixels all pictures take more than the limit",
                                     width, height)};
  return {};
}

// ---- PPM: "P6" or "P3", three numbers, the pixels; comments from # to the end of the line

class PpmReader {
 public:
  PpmReader(std::string_view bytes, std::uint64_t max_bytes, DecodedImage& out)
      : bytes_(bytes), max_bytes_(max_bytes), out_(out) {}

  ImageProblem run() {
    const bool text = bytes_[1] == '3';
    at_ = 2;
    std::uint64_t width = 0;
    std::uint64_t height = 0;
    std::uint64_t most = 0;
    if (!number(width) || !number(height) || !number(most))
      return {Code::E3001, "the PPM header holds no width, height and largest value"};
    if (most == 0 || most > 65535)
      return {Code::E3001, fmt::format("the PPM's largest value is {}; it takes 1 to 65535", most)};
    if (const ImageProblem problem = check_size(width, height, max_bytes_); problem.code)
      return problem;
    const std::uint64_t samples = 3 * width * height;
    const std::uint64_t sample_bytes = most > 255 ? 2 : 1;
    // in text a sample is a digit and a blank at least
    const std::uint64_t needed = text ? 2 * samples - 1 : 1 + samples * sample_bytes;
    if (bytes_.size() - at_ < needed)
      return {Code::E3001, fmt::format("the PPM is cut short: {} x {} pixels need {} bytes more",
                                       width, height, needed - (bytes_.size() - at_))};
    if (!text) ++at_;
    out_ = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
    out_.rgba.assign(4 * width * height, 255);
    for (std::uint64_t i = 0; i < samples; ++i) {
      std::uint64_t value = 0;
      if (text) {
        if (!number(value)) return {Code::E3001, "the PPM's pixels are no numbers, or too few"};
      } else {
        for (std::uint64_t k = 0; k < sample_bytes; ++k)
          value = value << 8 | static_cast<unsigned char>(bytes_[at_++]);
      }
      if (value > most)
        return {Code::E3001, fmt::format("a PPM value is {}, above its largest, {}", value, most)};
      out_.rgba[4 * (i / 3) + i % 3] = static_cast<std::uint8_t>((255 * value + most / 2) / most);
    }
    return {};
  }

 private:
  bool number(std::uint64_t& out) {
    while (at_ < bytes_.size() && (std::strchr(" \t\r\n\v\f", bytes_[at_]) || bytes_[at_] == '#')) {
      if (bytes_[at_] == '\0') return false;
      if (bytes_[at_] == '#') at_ = std::min(bytes_.find('\n', at_), bytes_.size() - 1);
      ++at_;
    }
    const std::size_t begin = at_;
    out = 0;
    while (at_ < bytes_.size() && bytes_[at_] >= '0' && bytes_[at_] <= '9' && at_ - begin < 9)
      out = 10 * out + static_cast<std::uint64_t>(bytes_[at_++] - '0');
    return at_ > begin;
  }

  std::string_view bytes_;
  std::uint64_t max_bytes_;
  DecodedImage& out_;
  std::size_t at_ = 0;
};

// ---- PNG and JPEG

std::uint32_t big_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k)
    value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

// Verifies the frame of a PNG: chunks and their checksums, which the decoder does not look at.
ImageProblem check_png(std::string_view bytes) {
  std::size_t at = kPngMark.size();
  while (true) {
    if (bytes.size() - at < 12) return {Code::E3001, "the PNG is cut short"};
    const std::uint32_t length = big_endian(bytes, at);
    if (length > bytes.size() - at - 12) return {Code::E3001, "the PNG is cut short"};
    const std::string_view content = bytes.substr(at + 4, 4 + std::size_t{length});
    const auto sum = crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size());
    if (sum != big_endian(bytes, at + 8 + length))
      return {Code::E3001, fmt::format("the PNG is damaged: its {} chunk has the wrong checksum",
                                       in_quotes(content.substr(0, 4)))};
    at += 12 + std::size_t{length};
    if (content.starts_with("IEND")) return {};
  }
}

// Whether the Huffman tables of a DHT segment, whose length stands at `at`, have 256 codes at most
// each. note: the decoder writes past its arrays where they have more.
bool sound_huffman_tables(std::string_view bytes, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0u;
  };
  const std::size_t end = at + (std::size_t{byte(at)} << 8 | byte(at + 1));
  for (at += 2; at < end;) {
    std::size_t codes = 0;
    for (std::size_t k = 1; k <= 16; ++k) codes += byte(at + k);
    if (codes > 256) return false;
    at += 17 + codes;
  }
  return true;
}

// Looks at every Huffman table that the decoder may read. Up to the first scan segments follow each
// other by their lengths, and what they hold is their own; behind it a damaged scan may end
// anywhere, so every mark of a table counts.
ImageProblem check_jpeg(std::string_view bytes) {
  constexpr unsigned char kTables = 0xc4;
  constexpr unsigned char kScan = 0xda;
  if (bytes.rfind("\xff\xd9") == std::string_view::npos)
    return {Code::E3001, "the JPEG is cut short"};
  const ImageProblem damaged{Code::E3001, "the JPEG is damaged: a Huffman table is too long"};
  std::size_t at = 2;
  unsigned char marker = 0;
  while (at + 3 < bytes.size() && marker != kScan) {
    if (bytes[at] != '\xff') {
      ++at;
      continue;
    }
    while (at + 3 < bytes.size() && bytes[at] == '\xff') ++at;
    marker = static_cast<unsigned char>(bytes[at++]);
    if (marker == kTables && !sound_huffman_tables(bytes, at)) return damaged;
    if (marker != kScan)
      at += std::size_t{static_cast<unsigned char>(bytes[at])} << 8 |
            static_cast<unsigned char>(bytes[at + 1]);
  }
  for (at = bytes.find("\xff\xc4", at); at != std::string_view::npos;
       at = bytes.find("\xff\xc4", at + 1))
    if (!sound_huffman_tables(bytes, at + 2)) return damaged;
  return {};
}

ImageProblem decode_with_stb(std::string_view bytes, bool png, std::uint64_t max_bytes,
                             DecodedImage& out) {
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0;
  int height = 0;
  int channels = 0;
  // note: asking for the size reads tables too
  if (!png)
    if (const ImageProblem problem = check_jpeg(bytes); problem.code) return problem;
  if (!stbi_info_from_memory(data, size, &width, &height, &channels)) {
    // note: the size check of stb fails here as well, and would say nothing about sizes
    if (png && bytes.size() >= 24 &&
        (big_endian(bytes, 16) > kMaxTextureSide || big_endian(bytes, 20) > kMaxTextureSide))
      return check_size(big_endian(bytes, 16), big_endian(bytes, 20), max_bytes);
    return {Code::E3001, fmt::format("the {} header is damaged ({})", png ? "PNG" : "JPEG",
                                     stbi_failure_reason())};
  }
  const auto columns = static_cast<std::uint64_t>(width);
  const auto rows = static_cast<std::uint64_t>(height);
  if (const ImageProblem problem = check_size(columns, rows, max_bytes); problem.code)
    return problem;
  if (png) {
    if (const ImageProblem problem = check_png(bytes); problem.code) return problem;
    // one bit a pixel is the least that a PNG stores
    if (columns * rows / 8 > kDeflateRatio * bytes.size())
      return {Code::E3001, "the PNG is too short for its size"};
  }
  const std::unique_ptr<stbi_uc, decltype(&std::free)> pixels(
      stbi_load_from_memory(data, size, &width, &height, &channels, 4), &std::free);
  if (!pixels)
    return {Code::E3001, fmt::format("the {} cannot be decoded ({})", png ? "PNG" : "JPEG",
                                     stbi_failure_reason())};
  out = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  out.rgba.assign(pixels.get(), pixels.get() + 4 * columns * rows);
  return {};
}

}  // namespace

ImageProblem decode_image(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                          DecodedImage& out) {
  const std::string_view text = as_text(bytes);
  if (text.starts_with("P6") || text.starts_with("P3"))
    return PpmReader(text, max_bytes, out).run();
  const bool png = text.starts_with(kPngMark);
  if (!png && !text.starts_with("\xff\xd8\xff"))
    return {Code::E3001, "it is neither a PPM (P6 or P3) nor a PNG nor a JPEG file"};
  if (bytes.size() > 0x7fffffffu) return {Code::E3002, "the file is larger than 2 GiB"};
  return decode_with_stb(text, png, max_bytes, out);
}

}  // namespace panwright::importers
