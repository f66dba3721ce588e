// Animated PNG against the frames that libpng reads out of it; contact sheets against their images.
#include "image/video.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/file.h"
#include "image/decode.h"
#include "image/png.h"
#include "image/shown.h"
#include "image/srgb.h"
#include "tests/support/process.h"

namespace panwright::image::video_test {
namespace {

namespace fs = std::filesystem;
using Pixels = std::vector<std::uint8_t>;

constexpr std::uint32_t kWidth = 60, kHeight = 40;

Pixels frame(unsigned k) {
  Pixels out;
  for (unsigned y = 0; y < kHeight; ++y)
    for (unsigned x = 0; x < kWidth; ++x)
      for (unsigned c = 0; c < 3; ++c)
        out.push_back(static_cast<std::uint8_t>(x * (k + 1) + 7 * y + 50 * c));
  return out;
}

std::uint32_t number(const std::string& bytes, std::size_t at) {
  std::uint32_t out = 0;
  for (std::size_t k = 0; k < 4; ++k) out = out << 8 | static_cast<std::uint8_t>(bytes[at + k]);
  return out;
}

struct Chunk {
  std::string name, content;
};

std::vector<Chunk> chunks(const std::string& file) {
  std::vector<Chunk> out;
  for (std::size_t at = 8; at < file.size();) {
    const std::size_t length = number(file, at);
    out.push_back({file.substr(at + 4, 4), file.substr(at + 8, length)});
    const std::string summed = file.substr(at + 4, 4 + length);
    EXPECT_EQ(
        crc32(0, reinterpret_cast<const Bytef*>(summed.data()), static_cast<uInt>(summed.size())),
        number(file, at + 8 + length));
    at += 12 + length;
  }
  return out;
}

std::string big_endian(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16),
          static_cast<char>(value >> 8), static_cast<char>(value)};
}

std::string with_length_and_crc(const Chunk& chunk) {
  const std::string summed = chunk.name + chunk.content;
  const auto crc =
      crc32(0, reinterpret_cast<const Bytef*>(summed.data()), static_cast<uInt>(summed.size()));
  return big_endian(static_cast<std::uint32_t>(chunk.content.size())) + summed +
         big_endian(static_cast<std::uint32_t>(crc));
}

class Videos : public testing::Test {
 protected:
  Videos() {
    for (unsigned k = 0; k < 5; ++k) {
      PngOptions options;
      options.channels = 3;
      options.says_srgb = true;
      paths_.emplace_back(folder_.write("f" + std::to_string(k) + ".png",
                                        png_file(kWidth, kHeight, frame(k), options)));
    }
  }
  const support::TemporaryFolder folder_;
  std::vector<fs::path> paths_;
};

TEST_F(Videos, AnimationHoldsItsFrames) {
  DiagnosticLog log;
  const std::string path = folder_ / "all.png";
  ASSERT_TRUE(write_animation(path, paths_, 25, log, {})) << to_text(log);
  const std::string file = support::contents(path);
  EXPECT_EQ(file.substr(0, 8), "\x89PNG\r\n\x1a\n");
  std::uint32_t sequence = 0;
  std::string header;
  std::vector<std::string> rows;
  for (const Chunk& chunk : chunks(file)) {
    if (chunk.name == "IHDR") header = chunk.content;
    if (chunk.name == "acTL") {
      EXPECT_EQ(number(chunk.content, 0), 5u);
      EXPECT_EQ(number(chunk.content, 4), 0u);
      EXPECT_TRUE(rows.empty());
    }
    if (chunk.name == "fcTL") {
      ASSERT_EQ(chunk.content.size(), 26u);
      EXPECT_EQ(number(chunk.content, 0), sequence++);
      EXPECT_EQ(number(chunk.content, 4), kWidth);
      EXPECT_EQ(number(chunk.content, 8), kHeight);
      EXPECT_EQ(number(chunk.content, 20), 0x00010019u);  // 1/25 s
      rows.emplace_back();
    }
    if (chunk.name == "IDAT") {
      EXPECT_EQ(rows.size(), 1u);
      rows.back() += chunk.content;
    }
    if (chunk.name == "fdAT") {
      EXPECT_EQ(number(chunk.content, 0), sequence++);
      rows.back() += chunk.content.substr(4);
    }
  }
  ASSERT_EQ(rows.size(), 5u);
  for (unsigned k = 0; k < 5; ++k) {
    const std::string one = file.substr(0, 8) + with_length_and_crc({"IHDR", header}) +
                            with_length_and_crc({"IDAT", rows[k]}) +
                            with_length_and_crc({"IEND", ""});
    DecodedImage image;
    const ImageProblem problem = decode_image(as_bytes(one), 1 << 20, image);
    ASSERT_FALSE(problem.code) << problem.message;
    const Pixels expected = frame(k);
    for (std::size_t i = 0; i < expected.size() / 3; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_EQ(image.rgba[4 * i + c], expected[3 * i + c]) << k << ' ' << i;
  }
}

TEST_F(Videos, BadFramesAreNamed) {
  DiagnosticLog log;
  const std::string out = folder_ / "all.png";
  const std::string broken =
      folder_.write("broken.png", support::contents(paths_[0]).substr(0, 90));
  EXPECT_FALSE(write_animation(out, std::vector<fs::path>{paths_[0], broken}, 25, log, {}));
  const std::string small = folder_.write("small.png", png_file(2, 2, Pixels(16, 9)));
  EXPECT_FALSE(write_animation(out, std::vector<fs::path>{paths_[0], small}, 25, log, {}));
  EXPECT_FALSE(write_sheet(out, std::vector<fs::path>{paths_[0], small}, 9, 64, log, {}));
  EXPECT_FALSE(write_sheet(out, std::vector<fs::path>{paths_[0], broken}, 9, 64, log, {}));
  EXPECT_FALSE(
      write_sheet(out, std::vector<fs::path>{folder_.path() / "none.png"}, 9, 64, log, {}));
  EXPECT_EQ(log.errors(), 5u) << to_text(log);
  EXPECT_FALSE(fs::exists(out));
}

// Four of five images in two columns, each reduced to a third: the mean of the light of 3 × 3.
TEST_F(Videos, SheetHasMeansOfBlocks) {
  DiagnosticLog log;
  const std::string path = folder_ / "sheet.png";
  ASSERT_TRUE(write_sheet(path, paths_, 4, 20, log, {})) << to_text(log);
  DecodedImage sheet;
  ASSERT_FALSE(decode_image(as_bytes(support::contents(path)), 1 << 20, sheet).code);
  ASSERT_EQ(sheet.width, 40u);
  ASSERT_EQ(sheet.height, 28u);  // 40 rows are 13 blocks and a third
  const unsigned chosen[] = {0, 1, 2, 4};
  for (unsigned k = 0; k < 4; ++k) {
    const Pixels image = frame(chosen[k]);
    for (unsigned y = 0; y < 14; ++y)
      for (unsigned x = 0; x < 20; ++x)
        for (unsigned c = 0; c < 3; ++c) {
          double sum = 0;
          int count = 0;
          for (unsigned v = 3 * y; v < std::min(3 * y + 3, kHeight); ++v)
            for (unsigned u = 3 * x; u < 3 * x + 3; ++u, ++count)
              sum += srgb_decoded(image[3 * (v * kWidth + u) + c]);
          const std::size_t at = (y + k / 2 * 14) * 40 + x + k % 2 * 20;
          ASSERT_EQ(sheet.rgba[4 * at + c], srgb_code(sum / count)) << k << ' ' << x << ' ' << y;
        }
  }
}

// Numbers of a detector, each pixel one of a ramp over all of them.
Pixels ramp(unsigned bits) {
  Pixels out;
  for (unsigned i = 0; i < kWidth * kHeight; ++i) {
    const unsigned number = ((1u << bits) - 1) * i / (kWidth * kHeight - 1);
    if (bits > 8) out.push_back(static_cast<std::uint8_t>(number >> 8));
    out.push_back(static_cast<std::uint8_t>(number));
  }
  return out;
}

// In sheets and animations they are light from black to white, whatever their bits are.
TEST_F(Videos, NumbersAreShownAsLight) {
  for (const unsigned bits : {8u, 10u, 12u, 16u}) {
    PngOptions options;
    options.channels = 1;
    options.bytes = bits > 8 ? 2 : 1;
    options.bits = bits;
    const fs::path file =
        folder_.write("numbers.png", png_file(kWidth, kHeight, ramp(bits), options));
    DiagnosticLog log;
    const std::string sheet = folder_ / "sheet.png", animation = folder_ / "animation.png";
    ASSERT_TRUE(write_sheet(sheet, {&file, 1}, 1, kWidth, log, {})) << to_text(log);
    ASSERT_TRUE(write_animation(animation, {&file, 1}, 25, log, {})) << to_text(log);
    for (const std::string& path : {sheet, animation}) {
      DecodedImage shown;
      ASSERT_FALSE(decode_image(as_bytes(support::contents(path)), 1 << 20, shown).code);
      const unsigned most = (1u << bits) - 1;
      for (unsigned i = 0; i < kWidth * kHeight; ++i) {
        const unsigned number = most * i / (kWidth * kHeight - 1);
        ASSERT_EQ(shown.rgba[4 * i], srgb_code(static_cast<double>(number) / most))
            << bits << ' ' << i;
      }
    }
  }
  // a grey PNG of others has codes, and so have colours
  PngOptions grey;
  grey.channels = 1;
  EXPECT_EQ(bits_of_numbers(as_bytes(png_file(kWidth, kHeight, ramp(8), grey))), 0u);
  EXPECT_EQ(bits_of_numbers(as_bytes(support::contents(paths_[0]))), 0u);
}

}  // namespace
}  // namespace panwright::image::video_test
