#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <regex>

#include "tests/support/oracles.h"

namespace panwright::oracles {

namespace {

template <class Weight>
ImageSum weighted_sum(const Image& image, const Weight& weight) {
  ImageSum out;
  std::array<Vec2, 3> first{};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Vec2 place(x + 0.5, y + 0.5);
      const double w = weight(place);
      const std::size_t pixel = static_cast<std::size_t>(y) * image.width + x;
      for (int c = 0; c < 3; ++c) {
        const double value = image.rgb[3 * pixel + c];
        if (!std::isfinite(value)) {
          ++out.not_finite;
          continue;
        }
        out.sum[c] += value * w;
        first[c] += value * w * place;
      }
    }
  }
  for (int c = 0; c < 3; ++c)
    if (out.sum[c] != 0) out.centre[c] = first[c] / out.sum[c];
  return out;
}

}  // namespace

ImageSum pinhole_sum(const Image& image, double focal_px, const Vec2& principal_px) {
  return weighted_sum(image, [&](const Vec2& place) {
    const Vec2 off = (place - principal_px) / focal_px;
    const double secant2 = 1 + glm::dot(off, off);
    return 1 / (focal_px * focal_px * secant2 * std::sqrt(secant2));
  });
}

ImageSum orthographic_sum(const Image& image, double pixel_metres) {
  return weighted_sum(image, [&](const Vec2&) { return pixel_metres * pixel_metres; });
}

std::optional<Image> read_npy(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 10> head{};
  if (!file.read(head.data(), head.size())) return std::nullopt;
  // the magic number, version 1, and a header length in two little-endian bytes
  if (std::memcmp(head.data(), "\x93NUMPY\x01", 7) != 0) return std::nullopt;
  const std::size_t length = static_cast<unsigned char>(head[8]) +
                             256 * static_cast<std::size_t>(static_cast<unsigned char>(head[9]));
  std::string text(length, ' ');
  if (!file.read(text.data(), static_cast<std::streamsize>(length))) return std::nullopt;
  if (text.find("'<f4'") == std::string::npos || text.find("False") == std::string::npos)
    return std::nullopt;
  static const std::regex kShape(R"(\(\s*(\d{1,5}),\s*(\d{1,5}),\s*3,?\s*\))");
  std::smatch match;
  if (!std::regex_search(text, match, kShape)) return std::nullopt;
  Image image;
  image.height = std::stoi(match[1]);
  image.width = std::stoi(match[2]);
  image.rgb.resize(std::size_t{3} * image.width * image.height);
  static_assert(std::endian::native == std::endian::little);
  if (!file.read(reinterpret_cast<char*>(image.rgb.data()),
                 static_cast<std::streamsize>(image.rgb.size() * sizeof(float))))
    return std::nullopt;
  return image;
}

}  // namespace panwright::oracles
