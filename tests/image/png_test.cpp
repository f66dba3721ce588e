#include "image/png.h"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

namespace panwright::image::png_test {
namespace {

using Pixels = std::vector<std::uint8_t>;

Pixels noise(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  Pixels out(size);
  for (auto& p : out) p = static_cast<std::uint8_t>(random());
  return out;
}

// What libpng's one-call reader makes of a file; `format` gets what it says the file holds.
Pixels read(const std::string& file, png_uint_32 wanted, png_uint_32* format = nullptr) {
  png_image head;
  std::memset(&head, 0, sizeof head);
  head.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&head, file.data(), file.size())) return {};
  if (format) *format = head.format;
  head.format = wanted;
  Pixels out(PNG_IMAGE_SIZE(head));
  if (!png_image_finish_read(&head, nullptr, out.data(), 0, nullptr)) return {};
  return out;
}

TEST(Png, PixelsComeBack) {
  for (const auto& [width, height] :
       {std::pair{1u, 1u}, std::pair{17u, 5u}, std::pair{300u, 200u}}) {
    const Pixels rgba = noise(std::size_t{4} * width * height, width);
    EXPECT_EQ(read(png_file(width, height, rgba), PNG_FORMAT_RGBA), rgba);
    PngOptions three;
    three.channels = 3;
    const Pixels rgb = noise(std::size_t{3} * width * height, height);
    EXPECT_EQ(read(png_file(width, height, rgb, three), PNG_FORMAT_RGB), rgb);
  }
}

TEST(Png, AlphaIsWrittenWhereItSaysSomething) {
  Pixels rgba = noise(4 * 6 * 4, 3);
  for (std::size_t i = 3; i < rgba.size(); i += 4) rgba[i] = 255;
  png_uint_32 format = 0;
  EXPECT_EQ(read(png_file(6, 4, rgba), PNG_FORMAT_RGBA, &format), rgba);
  EXPECT_EQ(format & PNG_FORMAT_FLAG_ALPHA, 0u);
  PngOptions keep;
  keep.drop_opaque_alpha = false;
  EXPECT_EQ(read(png_file(6, 4, rgba, keep), PNG_FORMAT_RGBA, &format), rgba);
  EXPECT_NE(format & PNG_FORMAT_FLAG_ALPHA, 0u);
  rgba[7] = 254;
  EXPECT_EQ(read(png_file(6, 4, rgba), PNG_FORMAT_RGBA, &format), rgba);
  EXPECT_NE(format & PNG_FORMAT_FLAG_ALPHA, 0u);
}

// Oracle: libpng's one-call writer, by its own choice of filters and level; it says sRGB of 8-bit
// images too.
TEST(Png, ColoursTakeLittleMoreThanByTheOneCallWriter) {
  // a ball, half of it lit
  constexpr std::uint32_t kSide = 256;
  Pixels rgb;
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const double u = x / 100.0 - 1.28, v = y / 100.0 - 1.28, z = 1 - u * u - v * v;
      const double lit = z > 0 ? std::max(0.6 * u - 0.3 * v + 0.7 * std::sqrt(z), 0.0) : 0;
      for (const double band : {250.0, 200.0, 120.0})
        rgb.push_back(static_cast<std::uint8_t>(band * std::sqrt(lit)));
    }
  png_image head;
  std::memset(&head, 0, sizeof head);
  head.version = PNG_IMAGE_VERSION;
  head.width = head.height = kSide;
  head.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(head);
  std::string expected(size, '\0');
  ASSERT_TRUE(png_image_write_to_memory(&head, expected.data(), &size, 0, rgb.data(), 0, nullptr));
  expected.resize(size);
  PngOptions options;
  options.channels = 3;
  options.says_srgb = true;
  const std::string file = png_file(kSide, kSide, rgb, options);
  EXPECT_EQ(read(file, PNG_FORMAT_RGB), rgb);
  const auto before_pixels = [](const std::string& of) {
    return of.substr(0, of.find("IDAT") - 4);
  };
  EXPECT_EQ(before_pixels(file), before_pixels(expected));
  EXPECT_LT(double(file.size()), 1.1 * double(expected.size()));  // measured: 1.082
}

}  // namespace
}  // namespace panwright::image::png_test
