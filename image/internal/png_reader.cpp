#include <fmt/core.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <vector>

#include "image/internal/image_reader.h"

namespace panwright::image {

namespace {

// deflate makes at most so many bytes of one
constexpr std::uint64_t kDeflateRatio = 1032;

class PngReader : private ImageReader {
 public:
  // codes: of numbers, as decode_numbers_png(); empty: pixels are codes themselves
  PngReader(std::span<const std::byte> bytes, std::uint64_t max_bytes, DecodedImage& out,
            RowReceiver* rows, std::span<const std::uint8_t> codes = {})
      : ImageReader("PNG", bytes, max_bytes, out, rows), codes_(codes) {}
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }

  ImageProblem run() {
    if (bytes_.size() < kPngHeaderEnd) return cut_short();
    // libpng would refuse these too, with less to say
    const std::uint64_t width = big_endian(bytes_, 16);
    const std::uint64_t height = big_endian(bytes_, 20);
    if (const ImageProblem problem = check_size(width, height); problem.code) return problem;
    if (!guarded([this] { begin(); })) return problem_found();
    if (png_ == nullptr || info_ == nullptr)
      return {Code("E3002"), "no memory is left for the PNG"};
    if (!guarded([this] { read_header(); })) return problem_found();
    if (row_bytes_ * height > kDeflateRatio * bytes_.size())
      return {Code("E3001"), fmt::format("the PNG is too short for {} x {} pixels", width, height)};
    if (const ImageProblem problem = make_room(width, height); problem.code) return problem;
    if (!codes_.empty()) numbers_.resize(row_bytes_);
    if (!guarded([this] { read_rows(); })) return problem_found();
    return {};
  }

 private:
  [[noreturn]] static void leave(png_structp png, png_const_charp message) {
    auto& self = *static_cast<PngReader*>(png_get_error_ptr(png));
    const std::size_t length = std::min(std::strlen(message), self.message_.size() - 1);
    std::memcpy(self.message_.data(), message, length);
    self.message_[length] = 0;
    self.stop();
  }
  static void ignore(png_structp, png_const_charp) {}
  static void read(png_structp png, png_bytep to, std::size_t size) {
    auto& self = *static_cast<PngReader*>(png_get_io_ptr(png));
    if (size > self.bytes_.size() - self.at_) {
      self.at_end_ = true;
      png_error(png, "end of file");
    }
    std::memcpy(to, self.bytes_.data() + self.at_, size);
    self.at_ += size;
  }

  void begin() {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, leave, ignore);
    if (png_ == nullptr) return;
    info_ = png_create_info_struct(png_);
    png_set_read_fn(png_, this, read);
    png_set_user_limits(png_, kMaxRowSide, kMaxRowSide);
    // chunks that only say how to show the image are passed over, but for their checksums, and cost
    // no memory; so they may be of any size
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_set_chunk_malloc_max(png_, 0);
    png_set_crc_action(png_, PNG_CRC_DEFAULT, PNG_CRC_ERROR_QUIT);
    png_set_benign_errors(png_, 1);
  }

  void read_header() {
    png_read_info(png_, info_);
    row_bytes_ = png_get_rowbytes(png_, info_);
    if (!codes_.empty()) return;
    png_set_expand(png_);
    png_set_strip_16(png_);
    png_set_gray_to_rgb(png_);
    png_set_add_alpha(png_, 255, PNG_FILLER_AFTER);
    passes_ = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
  }

  void read_rows() {
    if (!codes_.empty()) return read_numbers();
    if (png_get_rowbytes(png_, info_) != std::size_t{4} * out_.width)
      png_error(png_, "unexpected length of rows");
    for (int pass = 0; pass < passes_; ++pass)
      for (std::size_t y = 0; y < out_.height; ++y) {
        png_read_row(png_, row(y), nullptr);
        finish_row();
      }
    png_read_end(png_, nullptr);
  }

  void read_numbers() {
    const std::size_t bytes = row_bytes_ / out_.width;
    if (row_bytes_ != bytes * out_.width || bytes < 1 || bytes > 2)
      png_error(png_, "unexpected length of rows");
    for (std::size_t y = 0; y < out_.height; ++y) {
      png_read_row(png_, numbers_.data(), nullptr);
      std::uint8_t* rgba = row(y);
      for (std::size_t x = 0; x < out_.width; ++x) {
        std::size_t number = numbers_[bytes * x];
        if (bytes == 2) number = number << 8 | numbers_[2 * x + 1];
        const std::uint8_t code = codes_[std::min(number, codes_.size() - 1)];
        for (std::size_t k = 0; k < 3; ++k) rgba[4 * x + k] = code;
        rgba[4 * x + 3] = 255;
      }
      finish_row();
    }
    png_read_end(png_, nullptr);
  }

  ImageProblem problem_found() const {
    if (at_end_) return cut_short();
    return damaged("before", at_, message_.data());
  }

  std::size_t at_ = 0;
  bool at_end_ = false;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::size_t row_bytes_ = 0;  // of a row in the file
  int passes_ = 1;
  std::span<const std::uint8_t> codes_;
  std::vector<std::uint8_t> numbers_;  // a row of the file
  std::array<char, 128> message_{};
};

}  // namespace

ImageProblem decode_png(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                        DecodedImage& out, RowReceiver* rows) {
  return PngReader(bytes, max_bytes, out, rows).run();
}

ImageProblem decode_numbers_png(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                                std::span<const std::uint8_t> codes, DecodedImage& out) {
  return PngReader(bytes, max_bytes, out, nullptr, codes).run();
}

}  // namespace panwright::image
