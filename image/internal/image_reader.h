// Base of the image readers: limits of size, room for pixels, and exits by longjmp from a C
// library. Private to image.
#pragma once

#include <fmt/core.h>

#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <span>

#include "image/internal/image_codecs.h"

namespace panwright::image {

class ImageReader {
 public:
  ImageReader(const ImageReader&) = delete;
  ImageReader& operator=(const ImageReader&) = delete;

 protected:
  // kind: of the file, for messages. The arguments must outlive this.
  ImageReader(const char* kind, std::span<const std::byte> bytes, std::uint64_t max_bytes,
              DecodedImage& out, RowReceiver* rows)
      : bytes_(bytes), max_bytes_(max_bytes), out_(out), rows_(rows), kind_(kind) {}
  ~ImageReader() = default;

  // Problems: as check_image_size().
  ImageProblem check_size(std::uint64_t width, std::uint64_t height) const {
    return rows_ ? check_row_size(width, height) : check_image_size(width, height, max_bytes_);
  }
  // Allocates black pixels without alpha, or one row of them. Expects: a size that passes
  // check_size().
  ImageProblem make_room(std::uint64_t width, std::uint64_t height) {
    out_ = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
    out_.rgba.assign(4 * width * (rows_ ? 1 : height), 0);
    return rows_ ? rows_->begin({out_.width, out_.height, {}, {}}) : ImageProblem();
  }
  std::uint8_t* row(std::size_t y) {
    return out_.rgba.data() + (rows_ ? 0 : std::size_t{4} * out_.width * y);
  }
  // Expects: row(y) is complete, after those above it.
  void finish_row() {
    if (rows_) rows_->row(out_.rgba);
  }

  // Runs calls of a library; false when it stopped in one, by stop(). note: it leaves by longjmp
  // through these frames only: nothing in `calls` may own resources
  template <typename Calls>
  [[gnu::noinline]] bool guarded(const Calls& calls) {
    if (setjmp(jump_)) return false;
    calls();
    return true;
  }
  [[noreturn]] void stop() { std::longjmp(jump_, 1); }

  ImageProblem cut_short() const {
    return {Code("E3001"),
            fmt::format("the {} is cut short: it ends at byte {}", kind_, bytes_.size())};
  }
  // what: the library's message.
  ImageProblem damaged(const char* where, std::size_t at, const char* what) const {
    return {Code("E3001"),
            fmt::format("the {} is damaged {} byte {} ({})", kind_, where, at, what)};
  }

  std::span<const std::byte> bytes_;
  std::uint64_t max_bytes_;
  DecodedImage& out_;
  RowReceiver* rows_;  // null: the whole image is kept

 private:
  const char* kind_;
  std::jmp_buf jump_;
};

}  // namespace panwright::image
