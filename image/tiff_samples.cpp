#include "image/tiff_samples.h"

#include <fmt/core.h>

#include "image/internal/image_codecs.h"
#include "image/internal/tiff_file.h"

namespace panwright::image {

namespace {

constexpr std::uint64_t kTagBytes = 16u << 20;

ImageProblem damage_of(const TiffFile& file) {
  return {Code("E3001"), fmt::format("the TIFF is damaged ({})", file.message())};
}

template <class T>
std::vector<T> copied(TIFF* tiff, std::uint32_t tag) {
  const auto values = tiff_values<T>(tiff, tag);
  return {values.begin(), values.end()};
}

std::string text_of_tag(TIFF* tiff, std::uint32_t tag) {
  const auto values = tiff_values<char>(tiff, tag);
  return values.empty() ? std::string()
                        : std::string(values.data(), strnlen(values.data(), values.size()));
}

template <class T>
void widen(const std::byte* from, std::size_t stride, std::span<double> to) {
  for (double& value : to) {
    T stored;
    std::memcpy(&stored, from, sizeof stored);
    value = static_cast<double>(stored);
    from += stride;
  }
}

void numbers_of(const TiffHead& head, const std::byte* from, std::size_t stride,
                std::span<double> to) {
  using S = TiffHead::Sample;
  const auto as = [&]<class T>(T) { widen<T>(from, stride, to); };
  if (head.sample == S::real) return head.bits == 64 ? as(double{}) : as(float{});
  const bool is_signed = head.sample == S::signed_integer;
  switch (head.bits) {
    case 8:
      return is_signed ? as(std::int8_t{}) : as(std::uint8_t{});
    case 16:
      return is_signed ? as(std::int16_t{}) : as(std::uint16_t{});
    case 32:
      return is_signed ? as(std::int32_t{}) : as(std::uint32_t{});
    default:
      return is_signed ? as(std::int64_t{}) : as(std::uint64_t{});
  }
}

// Number of samples beside each other in memory.
std::uint32_t samples_together(TIFF* tiff, const TiffHead& head) {
  std::uint16_t planes = PLANARCONFIG_CONTIG;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &planes);
  return planes == PLANARCONFIG_SEPARATE ? 1 : head.bands;
}

ImageProblem decode_strips(const TiffFile& file, const TiffHead& head, std::uint32_t band,
                           std::uint32_t first, std::uint32_t count, const NumbersReceiver& to) {
  TIFF* tiff = file.get();
  const std::uint32_t together = samples_together(tiff, head);
  const std::size_t bytes = head.bits / 8;
  const auto line = static_cast<std::size_t>(TIFFScanlineSize(tiff));
  if (line < std::size_t{head.width} * together * bytes)
    return {Code("E3001"), "the TIFF has rows shorter than its width"};
  std::vector<std::byte> buffer(line);
  std::vector<double> values(head.width);
  // a compressed strip is decoded from its first row on
  std::uint16_t compression = COMPRESSION_NONE;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
  std::uint32_t high = 0;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &high);
  const std::uint32_t begin =
      compression == COMPRESSION_NONE ? first : first - first % std::max(high, 1u);
  for (std::uint32_t row = begin; row < first + count; ++row) {
    if (TIFFReadScanline(tiff, buffer.data(), row, static_cast<std::uint16_t>(band)) != 1)
      return damage_of(file);
    if (row < first) continue;
    numbers_of(head, buffer.data() + (together > 1 ? band * bytes : 0), together * bytes, values);
    if (!to(row, values)) return {};
  }
  return {};
}

ImageProblem decode_tiles(const TiffFile& file, const TiffHead& head, std::uint32_t band,
                          std::uint32_t first, std::uint32_t count, std::uint64_t max_bytes,
                          const NumbersReceiver& to) {
  TIFF* tiff = file.get();
  std::uint32_t wide = 0, high = 0;
  TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &wide);
  TIFFGetField(tiff, TIFFTAG_TILELENGTH, &high);
  const std::uint32_t together = samples_together(tiff, head);
  const std::size_t bytes = head.bits / 8;
  const auto size = static_cast<std::uint64_t>(TIFFTileSize64(tiff));
  if (wide == 0 || high == 0 || size < std::uint64_t{wide} * high * together * bytes)
    return {Code("E3001"), "the TIFF has tiles of no size"};
  if (size + std::uint64_t{high} * head.width * sizeof(double) > max_bytes)
    return {Code("E3002"), fmt::format("tiles of {} x {} pixels need too much memory", wide, high)};
  std::vector<std::byte> tile(size);
  std::vector<double> values(std::size_t{high} * head.width);
  for (std::uint32_t y = first / high * high; y < first + count; y += high) {
    for (std::uint32_t x = 0; x < head.width; x += wide) {
      if (TIFFReadTile(tiff, tile.data(), x, y, 0, static_cast<std::uint16_t>(band)) < 0)
        return damage_of(file);
      const std::uint32_t columns = std::min(wide, head.width - x);
      for (std::uint32_t k = 0; k < high; ++k)
        numbers_of(
            head,
            tile.data() + (std::size_t{k} * wide * together + (together > 1 ? band : 0)) * bytes,
            together * bytes, std::span(values).subspan(std::size_t{k} * head.width + x, columns));
    }
    const std::uint32_t end = std::min(y + high, first + count);
    for (std::uint32_t row = std::max(y, first); row < end; ++row)
      if (!to(row, std::span(values).subspan(std::size_t{row - y} * head.width, head.width)))
        return {};
  }
  return {};
}

}  // namespace

ImageProblem read_tiff_head(std::span<const std::byte> bytes, TiffHead& head) {
  TiffFile file(bytes);
  if (!file.open(kTagBytes)) return damage_of(file);
  TIFF* tiff = file.get();
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &head.width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &head.height);
  std::uint16_t bits = 1, samples = 1, format = SAMPLEFORMAT_UINT, photometric = 0;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &format);
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
  if (head.width == 0 || head.height == 0 || samples == 0)
    return {Code("E3001"), "the TIFF has no pixels"};
  const bool real = format == SAMPLEFORMAT_IEEEFP;
  const bool whole = format == SAMPLEFORMAT_UINT || format == SAMPLEFORMAT_INT;
  const bool good = (whole && (bits == 8 || bits == 16 || bits == 32 || bits == 64)) ||
                    (real && (bits == 32 || bits == 64));
  if (!good || photometric == PHOTOMETRIC_YCBCR)
    return {Code("E3001"),
            fmt::format("the TIFF has samples of {} bits of a kind that is not read, "
                        "expected integers of 8 to 64 bits or floats of 32 or 64",
                        bits)};
  head.bits = bits;
  head.bands = samples;
  head.sample = real                         ? TiffHead::Sample::real
                : format == SAMPLEFORMAT_INT ? TiffHead::Sample::signed_integer
                                             : TiffHead::Sample::unsigned_integer;
  head.big_endian = TIFFIsBigEndian(tiff) != 0;
  if (double(head.width) * head.height * samples * (bits / 8) >
      double(kMostTiffRatio) * double(bytes.size()))
    return {Code("E3001"),
            fmt::format("the TIFF is too short for {} x {} pixels", head.width, head.height)};
  head.pixel_scale = copied<double>(tiff, kPixelScale);
  head.tiepoint = copied<double>(tiff, kTiepoint);
  head.transformation = copied<double>(tiff, kTransformation);
  head.geo_doubles = copied<double>(tiff, kGeoDoubles);
  head.geo_keys = copied<std::uint16_t>(tiff, kGeoKeys);
  head.geo_ascii = text_of_tag(tiff, kGeoAscii);
  head.gdal_metadata = text_of_tag(tiff, kGdalMetadata);
  head.no_data = text_of_tag(tiff, kNoData);
  return {};
}

ImageProblem decode_tiff_numbers(std::span<const std::byte> bytes, const TiffHead& head,
                                 std::uint32_t band, std::uint32_t first, std::uint32_t count,
                                 std::uint64_t max_bytes, const NumbersReceiver& to) {
  if (count == 0) return {};
  TiffFile file(bytes, true);
  if (!file.open(max_bytes)) return damage_of(file);
  return TIFFIsTiled(file.get()) ? decode_tiles(file, head, band, first, count, max_bytes, to)
                                 : decode_strips(file, head, band, first, count, to);
}

}  // namespace panwright::image
