// A TIFF file in memory, opened with libtiff. Private to image.
#pragma once

#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>

namespace panwright::image {

// deflate and LZW make at most this many bytes of one
inline constexpr std::uint64_t kMostTiffRatio = 1400;

// "GeoTIFF Standard", OGC 19-008r4, 7; and GDAL's own tags.
inline constexpr std::uint32_t kPixelScale = 33550, kTiepoint = 33922, kTransformation = 34264,
                               kGeoKeys = 34735, kGeoDoubles = 34736, kGeoAscii = 34737,
                               kGdalMetadata = 42112, kNoData = 42113;

// Bytes in memory as libtiff reads a file; its messages.
class TiffFile {
 public:
  // mapped: strips that are not compressed are used where they lie
  explicit TiffFile(std::span<const std::byte> bytes, bool mapped = false)
      : bytes_(bytes), mapped_(mapped) {}
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
    tiff_ = TIFFClientOpenExt("", mapped_ ? "r" : "rm", this, read, write, seek, close, size, map,
                              unmap, options.get());
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
  static int map(thandle_t handle, void** base, toff_t* length) {
    const TiffFile& file = self(handle);
    if (!file.mapped_) return 0;
    // note: libtiff writes to it only where it is open for writing
    *base = const_cast<std::byte*>(file.bytes_.data());
    *length = file.bytes_.size();
    return 1;
  }
  static void unmap(thandle_t, void*, toff_t) {}
  static toff_t size(thandle_t handle) { return self(handle).bytes_.size(); }

  std::span<const std::byte> bytes_;
  bool mapped_ = false;
  std::uint64_t at_ = 0;
  TIFF* tiff_ = nullptr;
  std::array<char, 160> message_{};
};

// Values of a tag of any number of them; empty: it has none, or of another type.
template <class T>
std::span<const T> tiff_values(TIFF* tiff, std::uint32_t tag) {
  constexpr TIFFDataType kType = std::is_same_v<T, double>          ? TIFF_DOUBLE
                                 : std::is_same_v<T, std::uint16_t> ? TIFF_SHORT
                                                                    : TIFF_ASCII;
  static_assert(kType != TIFF_ASCII || std::is_same_v<T, char>);
  // libtiff hands out tags that it does not know as they are stored
  const TIFFField* const field = TIFFFieldWithTag(tiff, tag);
  std::uint32_t count = 0;
  const T* values = nullptr;
  if (field == nullptr || TIFFFieldDataType(field) != kType ||
      TIFFFieldReadCount(field) != TIFF_VARIABLE2 ||
      TIFFGetField(tiff, tag, &count, &values) != 1 || values == nullptr)
    return {};
  return {values, count};
}

}  // namespace panwright::image
