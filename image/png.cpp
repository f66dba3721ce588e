#include "image/png.h"

#include <png.h>

#include <algorithm>
#include <cassert>
#include <csetjmp>
#include <new>
#include <vector>

namespace panwright::image {

namespace {

class PngWriter {
 public:
  PngWriter(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> pixels,
            const PngOptions& options)
      : width_(width), height_(height), pixels_(pixels), options_(options) {
    const auto channels = static_cast<std::size_t>(options.channels);
    alpha_ = channels == 4 && !options.drop_opaque_alpha;
    for (std::size_t i = 3; channels == 4 && i < pixels.size() && !alpha_; i += 4)
      alpha_ = pixels[i] != 255;
    if (channels == 4 && !alpha_) row_.resize(std::size_t{3} * width);
  }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png_, &info_); }

  std::string run() {
    if (!write()) throw std::bad_alloc();
    return std::move(out_);
  }

 private:
  // False when memory is out: nothing else can go wrong. note: libpng leaves by longjmp, which
  // passes over frames that own nothing
  [[gnu::noinline]] bool write() {
    if (setjmp(jump_)) return false;
    png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, stop, ignore);
    info_ = png_ == nullptr ? nullptr : png_create_info_struct(png_);
    if (info_ == nullptr) return false;
    write_rows();
    return true;
  }

  void write_rows() {
    png_set_write_fn(png_, this, append, flush);
    png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    const int color = options_.channels == 1 ? PNG_COLOR_TYPE_GRAY
                      : alpha_               ? PNG_COLOR_TYPE_RGB_ALPHA
                                             : PNG_COLOR_TYPE_RGB;
    png_set_IHDR(png_, info_, width_, height_, 8 * options_.bytes, color, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    // as small, within a few per cent, as by libpng's own choice of filters and level 6, in a third
    // of the time
    constexpr int kLevel = 4;
    png_set_compression_level(png_, kLevel);
    if (options_.channels > 1) png_set_filter(png_, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    if (!options_.comment.empty()) {
      png_text text{};
      text.compression = PNG_TEXT_COMPRESSION_NONE;
      text.key = keyword_;
      text.text = options_.comment.data();
      png_set_text(png_, info_, &text, 1);
    }
    if (options_.says_srgb) png_set_sRGB(png_, info_, PNG_sRGB_INTENT_PERCEPTUAL);
    if (options_.bits > 0) {
      png_color_8 bits{};
      bits.gray = bits.red = bits.green = bits.blue = static_cast<png_byte>(options_.bits);
      png_set_sBIT(png_, info_, &bits);
    }
    png_write_info(png_, info_);
    const std::size_t step =
        static_cast<std::size_t>(options_.bytes * options_.channels) * std::size_t{width_};
    for (std::size_t y = 0; y < height_; ++y) {
      const std::uint8_t* row = pixels_.data() + y * step;
      png_write_row(png_, row_.empty() ? row : without_alpha(row));
    }
    png_write_end(png_, info_);
  }

  const std::uint8_t* without_alpha(const std::uint8_t* rgba) {
    for (std::size_t x = 0; x < width_; ++x) std::copy_n(rgba + 4 * x, 3, row_.data() + 3 * x);
    return row_.data();
  }

  bool keep(const char* data, std::size_t size) noexcept {
    try {
      out_.append(data, size);
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }
  static void append(png_structp png, png_bytep data, std::size_t size) {
    auto& self = *static_cast<PngWriter*>(png_get_io_ptr(png));
    if (!self.keep(reinterpret_cast<const char*>(data), size)) png_error(png, "out of memory");
  }
  static void flush(png_structp) {}
  [[noreturn]] static void stop(png_structp png, png_const_charp) {
    std::longjmp(static_cast<PngWriter*>(png_get_error_ptr(png))->jump_, 1);
  }
  static void ignore(png_structp, png_const_charp) {}

  std::uint32_t width_;
  std::uint32_t height_;
  std::span<const std::uint8_t> pixels_;
  PngOptions options_;
  char keyword_[8] = "Comment";  // note: libpng takes a mutable one
  bool alpha_ = false;
  std::vector<std::uint8_t> row_;  // where alpha is left out
  std::string out_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::jmp_buf jump_;
};

}  // namespace

std::string png_file(std::uint32_t width, std::uint32_t height,
                     std::span<const std::uint8_t> pixels, const PngOptions& options) {
  assert(options.channels == 1 || options.channels == 3 || options.channels == 4);
  assert(options.bytes == 1 || (options.bytes == 2 && options.channels != 4));
  assert(width > 0 && height > 0);
  assert(pixels.size() ==
         static_cast<std::size_t>(options.bytes * options.channels) * width * height);
  return PngWriter(width, height, pixels, options).run();
}

}  // namespace panwright::image
