#include <fmt/core.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include "image/internal/image_codecs.h"
#include "image/internal/tiff_file.h"

namespace panwright::image {

namespace {

constexpr std::uint16_t kModelType = 1024, kGeographic = 2;

// Extent in degrees, of files in geographic coordinates.
void read_place(TIFF* tiff, ImageHead& head) {
  const auto keys = tiff_values<std::uint16_t>(tiff, kGeoKeys);
  bool geographic = false;
  for (std::size_t i = 4; i + 3 < keys.size(); i += 4)
    geographic |= keys[i] == kModelType && keys[i + 1] == 0 && keys[i + 3] == kGeographic;
  const auto scale = tiff_values<double>(tiff, kPixelScale);
  const auto tie = tiff_values<double>(tiff, kTiepoint);
  if (geographic && scale.size() >= 2 && tie.size() >= 6)
    head.extent = Extent{tie[3] - tie[0] * scale[0], tie[4] + tie[1] * scale[1],
                         scale[0] * head.width, scale[1] * head.height};
  const auto none = tiff_values<char>(tiff, kNoData);
  if (!none.empty()) {
    double value = 0;
    const std::string text(none.data(), strnlen(none.data(), none.size()));
    if (std::sscanf(text.c_str(), "%lf", &value) == 1 && value >= 0 && value <= 255 &&
        value == std::floor(value))
      head.no_data = static_cast<std::uint8_t>(value);
  }
}

ImageProblem tiff_damage(const TiffFile& file) {
  return {Code("E3001"), fmt::format("the TIFF is damaged ({})", file.message())};
}

}  // namespace

ImageProblem decode_tiff_rows(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                              RowReceiver& to) {
  TiffFile file(bytes);
  if (!file.open(max_bytes)) return tiff_damage(file);
  TIFF* tiff = file.get();
  ImageHead head;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &head.width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &head.height);
  if (const ImageProblem problem = check_row_size(head.width, head.height); problem.code)
    return problem;
  std::uint16_t bits = 1, samples = 1;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
  std::array<char, 1024> why{};
  if (!TIFFRGBAImageOK(tiff, why.data()))
    return {Code("E3001"),
            fmt::format("the TIFF has pixels of a kind that is not read, expected grey, "
                        "RGB or a palette of up to 16 bits ({})",
                        why.data())};
  const std::uint64_t pixels = std::uint64_t{head.width} * head.height;
  if (pixels * bits / 8 > kMostTiffRatio * bytes.size())
    return {Code("E3001"),
            fmt::format("the TIFF is too short for {} x {} pixels", head.width, head.height)};
  read_place(tiff, head);
  if (const ImageProblem problem = to.begin(head); problem.code) return problem;
  const bool tiled = TIFFIsTiled(tiff) != 0;
  std::uint32_t rows = 0, columns = head.width;
  TIFFGetFieldDefaulted(tiff, tiled ? TIFFTAG_TILELENGTH : TIFFTAG_ROWSPERSTRIP, &rows);
  if (tiled) TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &columns);
  if (!tiled) rows = std::min(rows, head.height);
  if (rows == 0 || columns == 0) return {Code("E3001"), "the TIFF has strips or tiles of no size"};
  const std::uint64_t area = std::uint64_t{rows} * columns;
  const std::uint64_t band = std::uint64_t{rows} * head.width;
  if (4 * (area + band) > max_bytes)
    return {Code("E3002"),
            fmt::format("strips or tiles of {} x {} pixels need too much memory", columns, rows)};
  std::vector<std::uint32_t> part(area);
  std::vector<std::uint8_t> lines(4 * band);
  for (std::uint32_t y = 0; y < head.height; y += rows) {
    const std::uint32_t count = std::min(rows, head.height - y);
    for (std::uint32_t x = 0; x < head.width; x += columns) {
      const int good = tiled ? TIFFReadRGBATileExt(tiff, x, y, part.data(), 1)
                             : TIFFReadRGBAStripExt(tiff, y, part.data(), 1);
      if (good != 1) return tiff_damage(file);
      // parts begin at the bottom: tiles at that of the whole tile
      const std::uint32_t high = tiled ? rows : count;
      const std::uint32_t wide = std::min(columns, head.width - x);
      for (std::uint32_t row = 0; row < count; ++row)
        for (std::uint32_t column = 0; column < wide; ++column) {
          const std::uint32_t value = part[std::size_t{high - 1 - row} * columns + column];
          std::uint8_t* out = &lines[4 * (std::size_t{row} * head.width + x + column)];
          out[0] = static_cast<std::uint8_t>(TIFFGetR(value));
          out[1] = static_cast<std::uint8_t>(TIFFGetG(value));
          out[2] = static_cast<std::uint8_t>(TIFFGetB(value));
          out[3] = static_cast<std::uint8_t>(TIFFGetA(value));
        }
    }
    for (std::uint32_t row = 0; row < count; ++row)
      to.row(
          std::span(lines).subspan(std::size_t{4} * row * head.width, std::size_t{4} * head.width));
  }
  return {};
}

}  // namespace panwright::image
