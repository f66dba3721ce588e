#include "image/decode.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include "base/math.h"
#include "image/internal/image_codecs.h"

namespace panwright::image {

namespace {

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
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
      return {Code("E3001"), "the PPM header holds no width, height and largest value"};
    if (most == 0 || most > 65535)
      return {Code("E3001"),
              fmt::format("the PPM's largest value is {}, expected 1 to 65535", most)};
    if (const ImageProblem problem = check_image_size(width, height, max_bytes_); problem.code)
      return problem;
    const std::uint64_t samples = 3 * width * height;
    const std::uint64_t sample_bytes = most > 255 ? 2 : 1;
    // in text a sample is a digit and a blank at least
    const std::uint64_t needed = text ? 2 * samples - 1 : 1 + samples * sample_bytes;
    if (bytes_.size() - at_ < needed)
      return {Code("E3001"), fmt::format("the PPM is cut short: {} x {} pixels need {} bytes more",
                                         width, height, needed - (bytes_.size() - at_))};
    if (!text) ++at_;
    out_ = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
    out_.rgba.assign(4 * width * height, 255);
    for (std::uint64_t i = 0; i < samples; ++i) {
      std::uint64_t value = 0;
      if (text) {
        if (!number(value)) return {Code("E3001"), "the PPM's pixels are not numbers, or too few"};
      } else {
        for (std::uint64_t k = 0; k < sample_bytes; ++k)
          value = value << 8 | static_cast<unsigned char>(bytes_[at_++]);
      }
      if (value > most)
        return {Code("E3001"),
                fmt::format("a PPM value is {}, above its largest, {}", value, most)};
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

}  // namespace

ImageProblem check_image_size(std::uint64_t width, std::uint64_t height, std::uint64_t max_bytes) {
  if (width == 0 || height == 0)
    return {Code("E3001"), fmt::format("the image is {} x {} pixels", width, height)};
  if (width > kMaxTextureSide || height > kMaxTextureSide)
    return {Code("E3002"), fmt::format("the image is {} x {} pixels, expected at most {} a side",
                                       width, height, kMaxTextureSide)};
  if (4 * width * height > max_bytes)
    return {Code("E3002"),
            fmt::format("with {} x {} pixels the textures exceed the memory limit", width, height)};
  return {};
}

ImageProblem check_row_size(std::uint64_t width, std::uint64_t height) {
  if (width == 0 || height == 0) return check_image_size(width, height, ~std::uint64_t{0});
  if (width > kMaxRowSide || height > kMaxRowSide)
    return {Code("E3002"), fmt::format("the image is {} x {} pixels, expected at most {} a side",
                                       width, height, kMaxRowSide)};
  return {};
}

ImageProblem decode_rows(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                         RowReceiver& to) {
  const std::string_view text = as_text(bytes);
  DecodedImage image;
  const bool tiff = text.starts_with(std::string_view("II*\0", 4)) ||
                    text.starts_with(std::string_view("MM\0*", 4)) ||
                    text.starts_with(std::string_view("II+\0", 4)) ||
                    text.starts_with(std::string_view("MM\0+", 4));
  if (tiff) return decode_tiff_rows(bytes, max_bytes, to);
  constexpr std::size_t kInterlacing = 28;  // byte of a PNG's header
  if (text.starts_with("\x89PNG\r\n\x1a\n") && text.size() > kInterlacing &&
      text[kInterlacing] == 0)
    return decode_png(bytes, max_bytes, image, &to);
  if (text.starts_with("\xff\xd8\xff")) return decode_jpeg(bytes, max_bytes, image, &to);
  if (const ImageProblem problem = decode_image(bytes, max_bytes, image); problem.code)
    return problem;
  if (const ImageProblem problem = to.begin({image.width, image.height, {}, {}}); problem.code)
    return problem;
  const std::size_t line = std::size_t{4} * image.width;
  for (std::size_t y = 0; y < image.height; ++y)
    to.row(std::span(image.rgba).subspan(y * line, line));
  return {};
}

ImageProblem decode_image(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                          DecodedImage& out) {
  const std::string_view text = as_text(bytes);
  if (text.starts_with("P6") || text.starts_with("P3"))
    return PpmReader(text, max_bytes, out).run();
  if (text.starts_with("\x89PNG\r\n\x1a\n")) return decode_png(bytes, max_bytes, out);
  if (text.starts_with("\xff\xd8\xff")) return decode_jpeg(bytes, max_bytes, out);
  return {Code("E3001"), "unknown image format, expected PPM (P6 or P3), PNG or JPEG"};
}

std::optional<std::string> normal_map_problem(std::span<const std::uint8_t> rgba) {
  constexpr double kLength = 0.25;  // rounding, filtering and lossy compression change it by less
  constexpr double kMost = 0.5;     // of all texels: the room between the pieces of an atlas
  std::size_t used = 0, wrong = 0;
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
    if (rgba[i + 3] == 0) continue;
    ++used;
    const Vec3 n = Vec3(rgba[i], rgba[i + 1], rgba[i + 2]) / 127.5 - Vec3(1);
    if (!(n.z > 0) || std::fabs(glm::length(n) - 1) > kLength) ++wrong;
  }
  const double share =
      static_cast<double>(wrong) / static_cast<double>(std::max<std::size_t>(used, 1));
  if (!(share > kMost)) return std::nullopt;
  return fmt::format(
      "{:.0f} % of its texels are no unit vectors out of the surface, as those of a normal map are",
      100 * share);
}

}  // namespace panwright::image
