#include <fmt/core.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "image/internal/image_codecs.h"

namespace panwright::image {

namespace {

// deflate and LZW make at most so many bytes of one
constexpr std::uint64_t kMostRatio = 1400;

// "GeoTIFF Standard", OGC 19-008r4, 7; and GDAL's own tag.
constexpr std::uint32_t kPixelScale = 33550, kTiepoint = 33922, kGeoKeys = 34735, kNoData = 42113;
constexpr std::uint16_t kModelType = 1024, kGeographic = 2;

// Bytes in memory as libtiff reads a file; its messages.
class TiffFile {
 public:
  explicit TiffFile(std::span<const std::byte> bytes) : bytes_(bytes) {}
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;
  ~TiffFile() {
    if (tiff_) TIFFClose(tiff_);
  }

  bool open(std::uint64_t max_bytes) {
    const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(
        TIFFOpenOptionsAlloc(), TIFFOpenOptionsFree);
    if (!options) return false;
    constexpr std::uint64_t kTags = 1 << 20;
    TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(),
                                        static_cast<tmsize_t>(std::max(max_bytes, kTags)));
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep, this);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), ignore, this);
    // m: the file is not mapped, its bytes are read
    tiff_ = TIFFClientOpenExt("", "rm", this, read, write, seek, close, size, nullptr, nullptr,
                              options.get());
    return tiff_ != nullptr;
  }
  TIFF* get() const { return tiff_; }
  const char* message() const { return message_.data(); }

 private:
  static TiffFile& self(thandle_t handle) { return *static_cast<TiffFile*>(handle); }
  static int keep(TIFF*, void* user, const char*, const char* format, va_list arguments) {
    auto& file = *static_cast<TiffFile*>(user);
    // the first is the cause
    if (file.message_[0] == 0)
      std::vsnprintf(file.message_.data(), file.message_.size(), format, arguments);
    return 1;
  }
  static int ignore(TIFF*, void*, const char*, const char*, va_list) { return 1; }
  static tmsize_t read(thandle_t handle, void* to, tmsize_t count) {
    TiffFile& file = self(handle);
    const std::uint64_t left =
        file.bytes_.size() - std::min<std::uint64_t>(file.at_, file.bytes_.size());
    const auto got = std::min<std::uint64_t>(left, static_cast<std::uint64_t>(count));
    if (got > 0) std::memcpy(to, file.bytes_.data() + file.at_, got);
    file.at_ += got;
    return static_cast<tmsize_t>(got);
  }
  static tmsize_t write(thandle_t, void*, tmsize_t) { return 0; }
  static toff_t seek(thandle_t handle, toff_t offset, int whence) {
    TiffFile& file = self(handle);
    if (whence == SEEK_SET) file.at_ = offset;
    if (whence == SEEK_CUR) file.at_ += offset;
    if (whence == SEEK_END) file.at_ = file.bytes_.size() + offset;
    return file.at_;
  }
  static int close(thandle_t) { return 0; }
  static toff_t size(thandle_t handle) { return self(handle).bytes_.size(); }

  std::span<const std::byte> bytes_;
  std::uint64_t at_ = 0;
  TIFF* tiff_ = nullptr;
  std::array<char, 160> message_{};
};

template <class T>
std::span<const T> values_of(TIFF* tiff, std::uint32_t tag) {
  std::uint32_t count = 0;
  const T* values = nullptr;
  if (TIFFGetField(tiff, tag, &count, &values) != 1 || values == nullptr) return {};
  return {values, count};
}

// Extent in degrees, of files in geographic coordinates.
void read_place(TIFF* tiff, ImageHead& head) {
  const auto keys = values_of<std::uint16_t>(tiff, kGeoKeys);
  bool geographic = false;
  for (std::size_t i = 4; i + 3 < keys.size(); i += 4)
    geographic |= keys[i] == kModelType && keys[i + 1] == 0 && keys[i + 3] == kGeographic;
  const auto scale = values_of<double>(tiff, kPixelScale);
  const auto tie = values_of<double>(tiff, kTiepoint);
  if (geographic && scale.size() >= 2 && tie.size() >= 6)
    head.extent = Extent{tie[3] - tie[0] * scale[0], tie[4] + tie[1] * scale[1],
                         scale[0] * head.width, scale[1] * head.height};
  const auto none = values_of<char>(tiff, kNoData);
  if (!none.empty()) {
    double value = 0;
    const std::string text(none.data(), strnlen(none.data(), none.size()));
    if (std::sscanf(text.c_str(), "%lf", &value) == 1 && value >= 0 && value <= 255 &&
        value == std::floor(value))
      head.no_data = static_cast<std::uint8_t>(value);
  }
}

ImageProblem tiff_damage(const TiffFile& file) {
  return {Code::E3001, fmt::format("the TIFF is damaged ({})", file.message())};
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
    return {Code::E3001,
            fmt::format("the TIFF has pixels of a kind that is not read, expected grey, "
                        "RGB or a palette of up to 16 bits ({})",
                        why.data())};
  const std::uint64_t pixels = std::uint64_t{head.width} * head.height;
  if (pixels * bits / 8 > kMostRatio * bytes.size())
    return {Code::E3001,
            fmt::format("the TIFF is too short for {} x {} pixels", head.width, head.height)};
  read_place(tiff, head);
  if (const ImageProblem problem = to.begin(head); problem.code) return problem;
  const bool tiled = TIFFIsTiled(tiff) != 0;
  std::uint32_t rows = 0, columns = head.width;
  TIFFGetFieldDefaulted(tiff, tiled ? TIFFTAG_TILELENGTH : TIFFTAG_ROWSPERSTRIP, &rows);
  if (tiled) TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &columns);
  if (!tiled) rows = std::min(rows, head.height);
  if (rows == 0 || columns == 0) return {Code::E3001, "the TIFF has strips or tiles of no size"};
  const std::uint64_t area = std::uint64_t{rows} * columns;
  const std::uint64_t band = std::uint64_t{rows} * head.width;
  if (4 * (area + band) > max_bytes)
    return {Code::E3002,
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
