// Pictures: pixels against files made here byte by byte, and what is refused.

#include "importers/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <random>

#include "base/file.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wshadow"
#include <stb_image_write.h>
#pragma GCC diagnostic pop

namespace panwright::importers {
namespace {

using testing::HasSubstr;
using Pixels = std::vector<std::uint8_t>;

std::string big_endian(std::uint32_t value) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<char>(value >> shift));
  return out;
}

std::string chunk(const std::string& kind, const std::string& data) {
  const std::string content = kind + data;
  const auto sum = static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size())));
  return big_endian(static_cast<std::uint32_t>(data.size())) + content + big_endian(sum);
}

std::string deflated(const std::string& raw) {
  uLongf size = compressBound(static_cast<uLong>(raw.size()));
  std::string out(size, '\0');
  compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(raw.data()),
           static_cast<uLong>(raw.size()));
  out.resize(size);
  return out;
}

// Rows of samples, each row behind a filter byte of 0.
std::string png(std::uint32_t width, std::uint32_t height, int bits, int kind,
                const std::string& rows) {
  const std::string header = big_endian(width) + big_endian(height) + static_cast<char>(bits) +
                             static_cast<char>(kind) + std::string(3, '\0');
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", deflated(rows)) +
         chunk("IEND", "");
}

struct Decoded {
  ImageProblem problem;
  DecodedImage image;
};
Decoded decode(const std::string& bytes, std::uint64_t limit = 1u << 30) {
  Decoded out;
  out.problem = decode_image(as_bytes(bytes), limit, out.image);
  return out;
}

TEST(Image, PpmOfEachKind) {
  const Pixels expected = {255, 0, 0, 255, 0, 128, 255, 255};
  EXPECT_EQ(decode(std::string("P6\n2 1\n255\n\xff\0\0\0\x80\xff", 17)).image.rgba, expected);
  EXPECT_EQ(decode("P3 # a comment\n2 # another\n1 255\n255 0 0\n0 128 255").image.rgba, expected);
  // 16 bits: 0xffff, 0, 0, 0, 0x8080, 0xffff
  EXPECT_EQ(decode(std::string("P6 2 1 65535 \xff\xff\0\0\0\0\0\0\x80\x80\xff\xff", 25)).image.rgba,
            expected);
  // rounded to the nearest of 255 steps
  EXPECT_EQ(decode("P3 1 1 7 0 1 7").image.rgba, (Pixels{0, 36, 255, 255}));
}

TEST(Image, PngOfEachKind) {
  const Pixels expected = {1, 2, 3, 255, 4, 5, 6, 255};
  EXPECT_EQ(decode(png(2, 1, 8, 2, std::string("\0\1\2\3\4\5\6", 7))).image.rgba, expected);
  EXPECT_EQ(decode(png(2, 1, 8, 6, std::string("\0\1\2\3\7\4\5\6\10", 9))).image.rgba,
            (Pixels{1, 2, 3, 7, 4, 5, 6, 8}));
  EXPECT_EQ(decode(png(2, 1, 8, 0, std::string("\0\x09\x63", 3))).image.rgba,
            (Pixels{9, 9, 9, 255, 99, 99, 99, 255}));
  EXPECT_EQ(decode(png(2, 1, 16, 2, std::string("\0\1\xaa\2\xaa\3\xaa\4\xaa\5\xaa\6\xaa", 13)))
                .image.rgba,
            expected);
  EXPECT_EQ(decode(png(2, 1, 1, 0, std::string("\0\x40", 2))).image.rgba,
            (Pixels{0, 0, 0, 255, 255, 255, 255, 255}));
}

void to_string(void* context, void* data, int size) {
  static_cast<std::string*>(context)->append(static_cast<const char*>(data),
                                             static_cast<std::size_t>(size));
}

std::string jpeg(int width, int height, const Pixels& rgb) {
  std::string out;
  stbi_write_jpg_to_func(to_string, &out, width, height, 3, rgb.data(), 100);
  return out;
}

TEST(Image, JpegColours) {
  for (const Pixels& colour :
       {Pixels{255, 0, 0}, Pixels{0, 128, 255}, Pixels{17, 99, 3}, Pixels{255, 255, 255}}) {
    Pixels rgb;
    for (int i = 0; i < 40 * 24; ++i) rgb.insert(rgb.end(), colour.begin(), colour.end());
    const Decoded d = decode(jpeg(40, 24, rgb));
    ASSERT_FALSE(d.problem.code) << d.problem.message;
    ASSERT_EQ(d.image.width, 40u);
    ASSERT_EQ(d.image.height, 24u);
    // flat colours survive to rounding of the colour transform, there and back; measured 1
    for (std::size_t i = 0; i < d.image.rgba.size(); ++i)
      ASSERT_NEAR(d.image.rgba[i], i % 4 == 3 ? 255 : colour[i % 4], 2);
  }
}

TEST(Image, SizesAreRefusedBeforeAnythingIsAllocated) {
  for (const std::string& bytes :
       {std::string("P6 20000 4 255 "), std::string("P6 4 999999999 255 "), png(20000, 4, 8, 2, ""),
        png(4, 0x7fffffff, 8, 2, "")}) {
    const Decoded d = decode(bytes);
    EXPECT_EQ(d.problem.code, Code::E3002) << d.problem.message;
    EXPECT_THAT(d.problem.message, HasSubstr("up to 16384 a side"));
  }
  const Decoded much = decode("P6 100 100 255 " + std::string(30000, 'x'), 39999);
  EXPECT_EQ(much.problem.code, Code::E3002);
  EXPECT_FALSE(decode("P6 100 100 255 " + std::string(30000, 'x'), 40000).problem.code);
  // 16384 x 16384 pixels out of a few bytes
  EXPECT_EQ(decode(png(16384, 16384, 8, 2, "\0")).problem.code, Code::E3001);
}

TEST(Image, DamageIsRefused) {
  for (const std::string& bytes :
       {std::string(), std::string("P"), std::string("P6"), std::string("P6 1 1"),
        std::string("P6 1 1 255"), std::string("P6 1 1 255 ab"), std::string("P6 0 1 255 "),
        std::string("P6 1 1 0 abc"), std::string("P6 1 1 65536 abcdef"),
        std::string("P6 1 1 7 abc"), std::string("P3 1 1 255 1 2"), std::string("P3 1 1 255 1 2 x"),
        std::string("P3 1 1 9 1 2 10"), std::string("P6 # no end"), std::string("P5 1 1 255 a"),
        std::string("GIF89a"), std::string("\xff\xd8\xff\xe0"), std::string("\x89PNG\r\n\x1a\n")}) {
    EXPECT_EQ(decode(bytes).problem.code, Code::E3001) << bytes;
  }
  const std::string good = png(2, 2, 8, 2, std::string("\0\1\2\3\4\5\6\0\1\2\3\4\5\6", 14));
  ASSERT_FALSE(decode(good).problem.code);
  for (std::size_t n = 0; n < good.size(); ++n) {
    EXPECT_TRUE(decode(good.substr(0, n)).problem.code) << n;
    std::string changed = good;
    changed[n] = static_cast<char>(changed[n] ^ 0x10);
    EXPECT_TRUE(decode(changed).problem.code) << n << ": a PNG has a checksum over every byte";
  }
}

// The decoder alone writes past its arrays here.
TEST(Image, JpegTablesThatAreTooLongAreRefused) {
  const Pixels rgb(3 * 8 * 8, 99);
  const std::string good = jpeg(8, 8, rgb);
  ASSERT_FALSE(decode(good).problem.code);
  const std::size_t table = good.find("\xff\xc4");
  ASSERT_NE(table, std::string::npos);
  std::string counts = good;
  for (std::size_t k = 0; k < 16; ++k) counts[table + 5 + k] = '\xff';
  EXPECT_THAT(decode(counts).problem.message, HasSubstr("Huffman table is too long"));
  // behind the scan, where only a damaged file has one
  const std::string late = good.substr(0, good.size() - 2) + counts.substr(table, 400) + "\xff\xd9";
  EXPECT_THAT(decode(late).problem.message, HasSubstr("Huffman table is too long"));
  // inside a comment the same bytes are no table
  const std::string comment = "\xff\xfe" + std::string("\x01\x92", 2) + counts.substr(table, 400);
  EXPECT_EQ(decode(good.substr(0, 2) + comment + good.substr(2)).image.rgba,
            decode(good).image.rgba);
}

// A damaged JPEG may decode to something else, but always to the same.
TEST(Image, DamagedJpegsAreRefusedOrTheSameEachTime) {
  std::mt19937 random(5);
  Pixels rgb(3 * 33 * 17);
  for (auto& p : rgb) p = static_cast<std::uint8_t>(random());
  const std::string good = jpeg(33, 17, rgb);
  int refused = 0;
  for (std::size_t n = 0; n < good.size(); ++n) {
    std::string changed = good;
    changed[n] = static_cast<char>(changed[n] ^ (1u << n % 8));
    const Decoded a = decode(changed);
    const Decoded b = decode(changed);
    EXPECT_EQ(a.image.rgba, b.image.rgba);
    refused += a.problem.code.has_value();
    if (n > 3 && n + 2 < good.size()) {
      EXPECT_TRUE(decode(good.substr(0, n)).problem.code) << n;
    }
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace panwright::importers
