// TIFF files that libtiff writes, row by row; GeoTIFF tags; damage. And rows of other formats.
#include <gtest/gtest.h>
#include <tiffio.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "image/decode.h"

namespace panwright::image::tiff_test {
namespace {

class Rows : public RowReceiver {
 public:
  ImageProblem begin(const ImageHead& given) override {
    head = given;
    return {};
  }
  void row(std::span<const std::uint8_t> rgba) override {
    pixels.insert(pixels.end(), rgba.begin(), rgba.end());
  }
  ImageHead head;
  std::vector<std::uint8_t> pixels;
};

struct Kind {
  std::uint16_t samples, bits, compression;
  std::uint32_t tile;  // side; 0: strips of 5 rows
  const char* mode;
};

std::uint8_t value(std::uint32_t x, std::uint32_t y, std::uint32_t channel) {
  return static_cast<std::uint8_t>(7 * x + 13 * y + 50 * channel);
}

// tags of GeoTIFF: two degrees a pixel from a west
void add_place(TIFF* tiff, double west) {
  static const TIFFFieldInfo kTags[] = {
      {33550, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, const_cast<char*>("Scale")},
      {33922, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, const_cast<char*>("Tie")},
      {34735, -1, -1, TIFF_SHORT, FIELD_CUSTOM, 1, 1, const_cast<char*>("Keys")},
      {42113, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, const_cast<char*>("NoData")}};
  TIFFMergeFieldInfo(tiff, kTags, std::size(kTags));
  const double scale[3] = {2, 2, 0}, tie[6] = {0, 0, 0, west, 90, 0};
  const std::uint16_t keys[8] = {1, 1, 0, 1, 1024, 0, 1, 2};
  TIFFSetField(tiff, 33550, 3, scale);
  TIFFSetField(tiff, 33922, 6, tie);
  TIFFSetField(tiff, 34735, 8, keys);
  TIFFSetField(tiff, 42113, "9");
}

std::vector<std::byte> file(const Kind& kind, std::uint32_t width, std::uint32_t height,
                            bool place = false) {
  const auto path = std::filesystem::temp_directory_path() / "panwright_tiff_test.tif";
  TIFF* tiff = TIFFOpen(path.c_str(), kind.mode);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, kind.bits);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, kind.samples);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, kind.compression);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC,
               kind.samples == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
  if (place) add_place(tiff, 0);
  const std::uint32_t across = kind.tile ? kind.tile : width, down = kind.tile ? kind.tile : 5;
  if (kind.tile) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, kind.tile);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, kind.tile);
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, down);
  }
  const std::size_t bytes = kind.bits / 8;
  for (std::uint32_t top = 0; top < height; top += down)
    for (std::uint32_t left = 0; left < width; left += across) {
      const std::uint32_t rows = kind.tile ? down : std::min(down, height - top);
      std::vector<std::uint8_t> part;
      for (std::uint32_t y = 0; y < rows; ++y)
        for (std::uint32_t x = 0; x < across; ++x)
          for (std::uint32_t k = 0; k < kind.samples; ++k)
            for (std::size_t b = 0; b < bytes; ++b) part.push_back(value(left + x, top + y, k));
      const auto size = static_cast<tmsize_t>(part.size());
      if (kind.tile)
        TIFFWriteEncodedTile(tiff, TIFFComputeTile(tiff, left, top, 0, 0), part.data(), size);
      else
        TIFFWriteEncodedStrip(tiff, top / down, part.data(), size);
    }
  TIFFClose(tiff);
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(path);
  std::vector<std::byte> out(text.size());
  std::memcpy(out.data(), text.data(), text.size());
  return out;
}

constexpr std::uint64_t kRoom = 1 << 20;

TEST(DecodeRows, TiffOfEveryKind) {
  for (const Kind& kind : {Kind{3, 8, COMPRESSION_NONE, 0, "w"},
                           {1, 8, COMPRESSION_LZW, 0, "w"},
                           {3, 8, COMPRESSION_ADOBE_DEFLATE, 16, "w"},
                           {1, 16, COMPRESSION_PACKBITS, 0, "w"},
                           {3, 16, COMPRESSION_LZW, 16, "w"},
                           {3, 8, COMPRESSION_NONE, 32, "wb"},
                           {3, 8, COMPRESSION_LZW, 0, "w8"}}) {
    const std::string what = std::to_string(kind.samples) + " x " + std::to_string(kind.bits) +
                             ", compression " + std::to_string(kind.compression) + ", tile " +
                             std::to_string(kind.tile) + ' ' + kind.mode;
    Rows rows;
    const ImageProblem problem = decode_rows(file(kind, 37, 23), kRoom, rows);
    ASSERT_FALSE(problem.code) << what << ": " << problem.message;
    ASSERT_EQ(rows.head.width, 37u) << what;
    ASSERT_EQ(rows.pixels.size(), 4u * 37 * 23) << what;
    EXPECT_FALSE(rows.head.extent || rows.head.no_data);
    for (std::uint32_t y = 0; y < 23; ++y)
      for (std::uint32_t x = 0; x < 37; ++x)
        for (std::uint32_t k = 0; k < 4; ++k)
          ASSERT_EQ(rows.pixels[4 * (y * 37 + x) + k],
                    k == 3 ? 255 : value(x, y, kind.samples == 1 ? 0 : k))
              << what << ' ' << x << ' ' << y << ' ' << k;
  }
}

TEST(DecodeRows, GeoTiff) {
  Rows rows;
  const ImageProblem problem =
      decode_rows(file({1, 8, COMPRESSION_NONE, 0, "w"}, 180, 90, true), kRoom, rows);
  ASSERT_FALSE(problem.code) << problem.message;
  ASSERT_TRUE(rows.head.extent);
  EXPECT_EQ(rows.head.extent->west, 0);
  EXPECT_EQ(rows.head.extent->north, 90);
  EXPECT_EQ(rows.head.extent->width, 360);
  EXPECT_EQ(rows.head.extent->height, 180);
  EXPECT_EQ(rows.head.no_data, std::uint8_t{9});
}

// Cut anywhere, or with a byte changed: refused, or as many rows as there are.
TEST(DecodeRows, DamagedTiff) {
  for (const Kind& kind :
       {Kind{3, 8, COMPRESSION_LZW, 0, "w"}, {3, 8, COMPRESSION_ADOBE_DEFLATE, 16, "w8"}}) {
    const std::vector<std::byte> whole = file(kind, 37, 23, true);
    std::size_t refused = 0;
    for (std::size_t i = 0; i < whole.size(); i += 3) {
      Rows cut;
      const ImageProblem problem = decode_rows(std::span(whole).first(i), kRoom, cut);
      refused += problem.code.has_value();
      std::vector<std::byte> changed = whole;
      changed[i] ^= std::byte{0x5a};
      Rows rows;
      if (!decode_rows(changed, kRoom, rows).code) {
        EXPECT_EQ(rows.pixels.size(), std::size_t{4} * rows.head.width * rows.head.height) << i;
      }
    }
    EXPECT_GT(refused, whole.size() / 3 * 9 / 10);
  }
}

// Sizes that are too much, or of nothing.
TEST(DecodeRows, TooLarge) {
  Rows rows;
  const std::vector<std::byte> whole = file({3, 8, COMPRESSION_NONE, 0, "w"}, 37, 23);
  EXPECT_EQ(decode_rows(whole, 1000, rows).code, Code("E3002"));
}

// Rows of PPM as the whole image has them.
TEST(DecodeRows, Ppm) {
  const std::string text = "P3 2 2 255 1 2 3 4 5 6 7 8 9 10 11 12\n";
  Rows rows;
  ASSERT_FALSE(decode_rows(std::as_bytes(std::span(text)), kRoom, rows).code);
  EXPECT_EQ(rows.pixels,
            (std::vector<std::uint8_t>{1, 2, 3, 255, 4, 5, 6, 255, 7, 8, 9, 255, 10, 11, 12, 255}));
}

}  // namespace
}  // namespace panwright::image::tiff_test
