// Images: pixels against files made here byte by byte, and what is refused.

#include "image/decode.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>

#include <jpeglib.h>

#include "base/file.h"
#include "tests/image/image_oracle.h"

namespace panwright::image::decode_test {
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
class AllRows : public RowReceiver {
 public:
  ImageProblem begin(const ImageHead& head) override {
    image.width = head.width;
    image.height = head.height;
    return {};
  }
  void row(std::span<const std::uint8_t> rgba) override {
    image.rgba.insert(image.rgba.end(), rgba.begin(), rgba.end());
  }
  DecodedImage image;
};

// Whole; row by row the same comes.
Decoded decode(const std::string& bytes, std::uint64_t limit = 1u << 30) {
  Decoded out;
  out.problem = decode_image(as_bytes(bytes), limit, out.image);
  if (!out.problem.code) {
    AllRows rows;
    EXPECT_FALSE(decode_rows(as_bytes(bytes), limit, rows).code);
    EXPECT_EQ(rows.image.width, out.image.width);
    EXPECT_EQ(rows.image.height, out.image.height);
    EXPECT_TRUE(rows.image.rgba == out.image.rgba);
  }
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

std::string adam7(std::uint32_t width, std::uint32_t height,
                  std::uint8_t (*grey)(std::uint32_t, std::uint32_t)) {
  constexpr std::array<std::array<std::uint32_t, 4>, 7> kPasses = {{{0, 0, 8, 8},
                                                                    {4, 0, 8, 8},
                                                                    {0, 4, 4, 8},
                                                                    {2, 0, 4, 4},
                                                                    {0, 2, 2, 4},
                                                                    {1, 0, 2, 2},
                                                                    {0, 1, 1, 2}}};
  std::string rows;
  for (const auto& [x0, y0, step_x, step_y] : kPasses) {
    for (std::uint32_t y = y0; y < height && x0 < width; y += step_y) {
      rows += '\0';
      for (std::uint32_t x = x0; x < width; x += step_x) rows += static_cast<char>(grey(x, y));
    }
  }
  std::string file = png(width, height, 8, 0, rows);
  const std::string header =
      big_endian(width) + big_endian(height) + std::string("\x08\0\0\0\1", 5);
  return file.replace(8, 25, chunk("IHDR", header));
}

TEST(Image, InterlacedPng) {
  const auto grey = [](std::uint32_t x, std::uint32_t y) {
    return static_cast<std::uint8_t>(13 * x + 7 * y);
  };
  for (const std::uint32_t side : {1u, 2u, 5u, 9u, 16u}) {
    const Decoded d = decode(adam7(side, side + 3, grey));
    ASSERT_FALSE(d.problem.code) << d.problem.message;
    for (std::uint32_t y = 0; y < side + 3; ++y)
      for (std::uint32_t x = 0; x < side; ++x)
        ASSERT_EQ(d.image.rgba[4 * (y * side + x)], grey(x, y)) << x << ' ' << y;
  }
}

// Oracle: another decoder, on random texels of every colour type, depth and row filter, with and
// without transparent colours.
TEST(Image, PngOfEveryKindAsAnotherDecoderReadsIt) {
  std::mt19937 random(11);
  const std::map<int, std::pair<int, std::vector<int>>> kinds = {{0, {1, {1, 2, 4, 8, 16}}},
                                                                 {2, {3, {8, 16}}},
                                                                 {3, {1, {1, 2, 4, 8}}},
                                                                 {4, {2, {8, 16}}},
                                                                 {6, {4, {8, 16}}}};
  for (const auto& [kind, channels] : kinds) {
    for (const int bits : channels.second) {
      for (const bool transparent : {false, true}) {
        constexpr std::uint32_t kWidth = 19, kHeight = 23;
        const auto row = (kWidth * static_cast<unsigned>(channels.first * bits) + 7) / 8;
        std::string rows;
        for (std::uint32_t y = 0; y < kHeight; ++y) {
          rows += static_cast<char>(y % 5);
          for (unsigned i = 0; i < row; ++i) rows += static_cast<char>(random() & 0xf3);
        }
        std::string file = png(kWidth, kHeight, bits, kind, rows);
        std::string more;
        if (kind == 3)
          for (int i = 0; i < 3 << bits; ++i) more += static_cast<char>(random());
        if (kind == 3) more = chunk("PLTE", more);
        if (transparent && kind == 3) more += chunk("tRNS", std::string("\0\x80", 2));
        if (transparent && kind == 0) more += chunk("tRNS", std::string("\0\1", 2));
        if (transparent && kind == 2) more += chunk("tRNS", std::string("\0\1\0\1\0\1", 6));
        file.insert(33, more);
        const Decoded d = decode(file);
        const auto oracle = oracle_decoded(file);
        ASSERT_TRUE(oracle);
        ASSERT_FALSE(d.problem.code) << kind << ' ' << bits << ' ' << d.problem.message;
        EXPECT_EQ(d.image.rgba, oracle->rgba) << kind << ' ' << bits << ' ' << transparent;
      }
    }
  }
}

// Chunks that only say how to show the image change nothing, however large, but for damage.
TEST(Image, AncillaryChunksOfPng) {
  const std::string plain = png(2, 1, 8, 2, std::string("\0\1\2\3\4\5\6", 7));
  const std::string gamma = chunk("gAMA", big_endian(22222));
  const std::string text = chunk("zTXt", "k" + std::string(2, '\0') + std::string(9 << 20, 'x'));
  std::string file = plain;
  file.insert(33, gamma + text);
  EXPECT_EQ(decode(file).image.rgba, decode(plain).image.rgba);
  file[33 + gamma.size() + 5000] ^= 1;
  EXPECT_THAT(decode(file).problem.message, HasSubstr("zTXt: CRC error"));
}

std::string jpeg(int width, int height, const Pixels& rgb) {
  return oracle_jpeg(width, height, rgb, 100);
}

struct JpegKind {
  const char* name;
  int components = 3;
  J_COLOR_SPACE colors = JCS_YCbCr;
  int across = 1, down = 1;  // of the first component
  bool progressive = false;
  bool arithmetic = false;
  int restart = 0;               // blocks
  double largest = 0, mean = 0;  // difference from the other decoder, measured
};

// Written by the library itself, which the decoding does not depend on.
std::string packed(const JpegKind& kind, unsigned width, unsigned height, const Pixels& samples,
                   int scans = 0) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = width;
  jpeg.image_height = height;
  jpeg.input_components = kind.components;
  jpeg.in_color_space = kind.components == 1   ? JCS_GRAYSCALE
                        : kind.components == 4 ? JCS_CMYK
                                               : JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_colorspace(&jpeg, kind.colors);
  jpeg_set_quality(&jpeg, 90, TRUE);
  jpeg.comp_info[0].h_samp_factor = kind.across;
  jpeg.comp_info[0].v_samp_factor = kind.down;
  if (kind.progressive) jpeg_simple_progression(&jpeg);
  jpeg.arith_code = kind.arithmetic ? TRUE : FALSE;
  jpeg.restart_interval = static_cast<unsigned>(kind.restart);
  std::vector<jpeg_scan_info> script;
  if (scans > 0) {  // the same empty refinement, time and again
    script.push_back({3, {0, 1, 2, 0}, 0, 0, 0, 0});
    for (int i = 1; i < scans; ++i)
      script.push_back({1, {0, 0, 0, 0}, i % 63 + 1, i % 63 + 1, 0, 0});
    jpeg.scan_info = script.data();
    jpeg.num_scans = scans;
  }
  jpeg_start_compress(&jpeg, TRUE);
  const std::size_t row = static_cast<std::size_t>(kind.components) * width;
  while (jpeg.next_scanline < height) {
    JSAMPROW rows[] = {const_cast<JSAMPROW>(samples.data()) + row * jpeg.next_scanline};
    jpeg_write_scanlines(&jpeg, rows, 1);
  }
  jpeg_finish_compress(&jpeg);
  std::string out(reinterpret_cast<char*>(bytes), size);
  jpeg_destroy_compress(&jpeg);
  std::free(bytes);
  return out;
}

// Smooth texels with an edge.
Pixels waves(unsigned width, unsigned height, int components) {
  Pixels out;
  for (unsigned y = 0; y < height; ++y)
    for (unsigned x = 0; x < width; ++x)
      for (int k = 0; k < components; ++k)
        out.push_back(static_cast<std::uint8_t>(
            x > y + 20 ? 30 + 60 * k : 128 + static_cast<int>((x * (3 + k) + y * 5) % 97)));
  return out;
}

// Oracle: another decoder. The two round in other places of the inverse DCT and of the
// interpolation of chroma.
TEST(Image, JpegOfEveryKindAsAnotherDecoderReadsIt) {
  const JpegKind kinds[] = {
      {"444", 3, JCS_YCbCr, 1, 1, false, false, 0, 2, 0.015},
      {"422", 3, JCS_YCbCr, 2, 1, false, false, 0, 2, 0.12},
      {"420", 3, JCS_YCbCr, 2, 2, false, false, 0, 2, 0.05},
      {"440", 3, JCS_YCbCr, 1, 2, false, false, 0, 3, 0.12},
      {"progressive", 3, JCS_YCbCr, 2, 2, true, false, 0, 2, 0.05},
      {"restarts", 3, JCS_YCbCr, 2, 1, false, false, 3, 2, 0.12},
      {"rgb", 3, JCS_RGB, 1, 1, false, false, 0, 1, 0.007},
      {"grey", 1, JCS_GRAYSCALE, 1, 1, false, false, 0, 1, 0.01},
      {"cmyk", 4, JCS_CMYK, 1, 1, false, false, 0, 1, 0.009},
      {"ycck", 4, JCS_YCCK, 1, 1, false, false, 0, 3, 0.05},
  };
  for (const JpegKind& kind : kinds) {
    constexpr unsigned kWidth = 83, kHeight = 61;
    const std::string file = packed(kind, kWidth, kHeight, waves(kWidth, kHeight, kind.components));
    const Decoded d = decode(file);
    const auto oracle = oracle_decoded(file);
    ASSERT_FALSE(d.problem.code) << kind.name << d.problem.message;
    ASSERT_TRUE(oracle) << kind.name;
    ASSERT_EQ(d.image.rgba.size(), oracle->rgba.size());
    double largest = 0, sum = 0;
    for (std::size_t i = 0; i < oracle->rgba.size(); ++i) {
      // at the end of rows the other one interpolates 4:2:2 with its weights exchanged
      if (kind.across == 2 && kind.down == 1 && i / 4 % kWidth + 2 >= kWidth) continue;
      const double difference = std::abs(d.image.rgba[i] - oracle->rgba[i]);
      largest = std::max(largest, difference);
      sum += difference;
    }
    EXPECT_LE(largest, kind.largest) << kind.name;
    EXPECT_LE(sum / static_cast<double>(oracle->rgba.size()), kind.mean) << kind.name;
  }
}

// Arithmetic coding holds the same coefficients as Huffman coding.
TEST(Image, ArithmeticJpegIsTheSameAsHuffman) {
  JpegKind kind{"", 3, JCS_YCbCr, 2, 2};
  const Pixels rgb = waves(50, 40, 3);
  const Decoded huffman = decode(packed(kind, 50, 40, rgb));
  kind.arithmetic = true;
  EXPECT_EQ(decode(packed(kind, 50, 40, rgb)).image.rgba, huffman.image.rgba);
}

// Inks without Adobe's mark are not inverted: none of any is white, all black is black.
TEST(Image, CmykWithoutAdobesMark) {
  for (const auto& [inks, grey] : {std::pair{0, 255}, std::pair{255, 0}}) {
    const Pixels flat(4 * 16 * 16, static_cast<std::uint8_t>(inks));
    std::string file = packed({"", 4, JCS_CMYK}, 16, 16, flat);
    const std::size_t adobe = file.find("\xff\xee");
    ASSERT_NE(adobe, std::string::npos);
    file.erase(adobe, 16);
    const Decoded d = decode(file);
    ASSERT_FALSE(d.problem.code) << d.problem.message;
    EXPECT_EQ(d.image.rgba[0], grey);
    EXPECT_EQ(d.image.rgba[3], 255);
  }
}

TEST(Image, JpegsAreLimitedInScans) {
  const Pixels rgb = waves(64, 64, 3);
  const JpegKind kind{""};
  EXPECT_FALSE(decode(packed(kind, 64, 64, rgb, 64)).problem.code);
  std::string many = packed(kind, 64, 64, rgb, 64);
  // the last scan again and again
  const std::size_t scan = many.rfind("\xff\xda");
  const std::string again = many.substr(scan, many.size() - 2 - scan);
  std::string copies;
  for (int i = 0; i < 200; ++i) copies += again;
  many.insert(many.size() - 2, copies);
  const Decoded d = decode(many);
  EXPECT_EQ(d.problem.code, Code("E3002"));
  EXPECT_THAT(d.problem.message, HasSubstr("more than 200 scans"));
}

TEST(Image, JpegColors) {
  for (const Pixels& color :
       {Pixels{255, 0, 0}, Pixels{0, 128, 255}, Pixels{17, 99, 3}, Pixels{255, 255, 255}}) {
    Pixels rgb;
    for (int i = 0; i < 40 * 24; ++i) rgb.insert(rgb.end(), color.begin(), color.end());
    const Decoded d = decode(jpeg(40, 24, rgb));
    ASSERT_FALSE(d.problem.code) << d.problem.message;
    ASSERT_EQ(d.image.width, 40u);
    ASSERT_EQ(d.image.height, 24u);
    // flat colours survive to rounding of the colour transform, there and back; measured 1
    for (std::size_t i = 0; i < d.image.rgba.size(); ++i)
      ASSERT_NEAR(d.image.rgba[i], i % 4 == 3 ? 255 : color[i % 4], 2);
  }
}

TEST(Image, SizesAreRefusedBeforeAnythingIsAllocated) {
  for (const std::string& bytes :
       {std::string("P6 20000 4 255 "), std::string("P6 4 999999999 255 "), png(20000, 4, 8, 2, ""),
        png(4, 0x7fffffff, 8, 2, "")}) {
    const Decoded d = decode(bytes);
    EXPECT_EQ(d.problem.code, Code("E3002")) << d.problem.message;
    EXPECT_THAT(d.problem.message, HasSubstr("at most 16384 a side"));
  }
  const Decoded much = decode("P6 100 100 255 " + std::string(30000, 'x'), 39999);
  EXPECT_EQ(much.problem.code, Code("E3002"));
  EXPECT_FALSE(decode("P6 100 100 255 " + std::string(30000, 'x'), 40000).problem.code);
  // 16384 x 16384 pixels out of a few bytes
  EXPECT_EQ(decode(png(16384, 16384, 8, 2, "\0")).problem.code, Code("E3001"));
}

TEST(Image, DamageIsRefused) {
  for (const std::string& bytes :
       {std::string(), std::string("P"), std::string("P6"), std::string("P6 1 1"),
        std::string("P6 1 1 255"), std::string("P6 1 1 255 ab"), std::string("P6 0 1 255 "),
        std::string("P6 1 1 0 abc"), std::string("P6 1 1 65536 abcdef"),
        std::string("P6 1 1 7 abc"), std::string("P3 1 1 255 1 2"), std::string("P3 1 1 255 1 2 x"),
        std::string("P3 1 1 9 1 2 10"), std::string("P6 # no end"), std::string("P5 1 1 255 a"),
        std::string("GIF89a"), std::string("\xff\xd8\xff\xe0"), std::string("\x89PNG\r\n\x1a\n")}) {
    EXPECT_EQ(decode(bytes).problem.code, Code("E3001")) << bytes;
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

TEST(Image, JpegTablesThatAreTooLongAreRefused) {
  const Pixels rgb(3 * 8 * 8, 99);
  const std::string good = jpeg(8, 8, rgb);
  ASSERT_FALSE(decode(good).problem.code);
  const std::size_t table = good.find("\xff\xc4");
  ASSERT_NE(table, std::string::npos);
  std::string counts = good;
  for (std::size_t k = 0; k < 16; ++k) counts[table + 5 + k] = '\xff';
  EXPECT_THAT(decode(counts).problem.message, HasSubstr("Huffman table"));
  // behind the scan, where only a damaged file has one
  const std::string late = good.substr(0, good.size() - 2) + counts.substr(table, 400) + "\xff\xd9";
  EXPECT_THAT(decode(late).problem.message, HasSubstr("Huffman table"));
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
  ASSERT_FALSE(decode(good).problem.code);
  int refused = 0;
  for (std::size_t n = 0; n < good.size(); ++n) {
    std::string changed = good;
    changed[n] = static_cast<char>(changed[n] ^ (1u << n % 8));
    const Decoded a = decode(changed);
    const Decoded b = decode(changed);
    EXPECT_EQ(a.image.rgba, b.image.rgba);
    refused += a.problem.code.has_value();
    if (n > 3 && n + 2 < good.size()) {
      EXPECT_THAT(decode(good.substr(0, n)).problem.message,
                  HasSubstr("cut short: it ends at byte " + std::to_string(n)));
    }
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace panwright::image::decode_test
