#include "image/gif.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>

namespace panwright::image {

namespace {

constexpr std::uint64_t kMostPixelsPerByte = 2731;  // strings of 4096 pixels by codes of 12 bits

struct Damaged {
  std::string what;
};

class GifReader {
 public:
  GifReader(std::span<const std::byte> bytes, std::uint64_t max_bytes, DecodedImage& out)
      : bytes_(bytes), max_bytes_(max_bytes), out_(out) {}

  ImageProblem run() {
    try {
      return read();
    } catch (const Damaged& damaged) {
      return {Code("E3001"), fmt::format("the GIF is damaged: {}", damaged.what)};
    }
  }

 private:
  struct Frame {
    std::uint32_t left = 0;
    std::uint32_t top = 0;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    bool interlaced = false;
  };

  unsigned byte() {
    if (at_ >= bytes_.size()) throw Damaged{fmt::format("it ends at byte {}", at_)};
    return std::to_integer<unsigned>(bytes_[at_++]);
  }
  std::uint32_t pair() {
    const unsigned low = byte();
    return low | byte() << 8;
  }
  void skip(std::size_t count) {
    if (count > bytes_.size() - at_) throw Damaged{fmt::format("it ends in block {}", at_)};
    at_ += count;
  }
  void skip_blocks() {
    for (unsigned size = byte(); size > 0; size = byte()) skip(size);
  }
  void read_colors(unsigned flags) {
    const std::size_t count = std::size_t{2} << (flags & 7);
    colors_ = at_;
    color_count_ = count;
    skip(3 * count);
  }

  ImageProblem read() {
    at_ = 6;  // "GIF89a"
    out_.width = pair();
    out_.height = pair();
    const unsigned flags = byte();
    skip(2);
    if (flags & 0x80) read_colors(flags);
    for (;;) {
      switch (byte()) {
        case 0x21:  // an extension
          if (byte() == 0xf9) {
            read_control();
          }
          skip_blocks();
          break;
        case 0x2c:
          return read_frame();
        case 0x3b:
          throw Damaged{"it holds no image"};
        default:
          throw Damaged{fmt::format("byte {} is not the start of a block", at_ - 1)};
      }
    }
  }

  // What is transparent in the image that follows.
  void read_control() {
    const std::size_t begin = at_;
    if (byte() == 4) {
      const unsigned flags = byte();
      skip(2);
      const unsigned index = byte();
      transparent_ = flags & 1 ? static_cast<int>(index) : -1;
    }
    at_ = begin;
  }

  ImageProblem read_frame() {
    Frame frame;
    frame.left = pair();
    frame.top = pair();
    frame.width = pair();
    frame.height = pair();
    const unsigned flags = byte();
    frame.interlaced = flags & 0x40;
    if (flags & 0x80) read_colors(flags);
    // screens of no size, and images that lie outside of theirs, are common
    out_.width = std::max(out_.width, frame.left + frame.width);
    out_.height = std::max(out_.height, frame.top + frame.height);
    const std::uint64_t pixels = std::uint64_t{out_.width} * out_.height;
    if (frame.width == 0 || frame.height == 0)
      return {Code("E3001"), fmt::format("the image is {} x {} pixels", frame.width, frame.height)};
    if (out_.width > kMaxTextureSide || out_.height > kMaxTextureSide)
      return {Code("E3002"), fmt::format("the image is {} x {} pixels, expected at most {} a side",
                                         out_.width, out_.height, kMaxTextureSide)};
    if (4 * pixels > max_bytes_)
      return {Code("E3002"), fmt::format("with {} x {} pixels the textures exceed the memory limit",
                                         out_.width, out_.height)};
    if (pixels > kMostPixelsPerByte * bytes_.size()) throw Damaged{"it is too short for its size"};
    out_.rgba.assign(4 * pixels, 0);
    decode(frame);
    return {};
  }

  // ---- LZW

  // The next code, or −1 at the end of the blocks.
  int code(unsigned size) {
    while (bit_count_ < size) {
      if (in_block_ == 0) {
        in_block_ = byte();
        if (in_block_ == 0) return -1;
      }
      bits_ |= byte() << bit_count_;
      bit_count_ += 8;
      --in_block_;
    }
    const unsigned out = bits_ & ((1u << size) - 1);
    bits_ >>= size;
    bit_count_ -= size;
    return static_cast<int>(out);
  }

  void decode(const Frame& frame) {
    const unsigned least = byte();
    if (least < 1 || least > 8) throw Damaged{fmt::format("codes of {} bits", least)};
    const int clear = 1 << least;
    const int stop = clear + 1;
    std::array<std::uint16_t, 4096> before{};
    std::array<std::uint8_t, 4096> last{};
    std::array<std::uint8_t, 4096> string{};
    for (int i = 0; i < clear; ++i)
      last[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(i);
    int next = stop + 1;
    unsigned size = least + 1;
    int previous = -1;
    const std::uint64_t wanted = std::uint64_t{frame.width} * frame.height;
    for (std::uint64_t done = 0; done < wanted;) {
      const int now = code(size);
      if (now < 0 || now == stop)
        throw Damaged{fmt::format("{} of {} pixels are there", done, wanted)};
      if (now == clear) {
        next = stop + 1;
        size = least + 1;
        previous = -1;
        continue;
      }
      if (now > next || (now == next && previous < 0) || (previous < 0 && now > stop))
        throw Damaged{fmt::format("a code before byte {} is undefined", at_)};
      // the string of a code that is being made is that of the one before, and its first pixel
      std::size_t length = 0;
      int walk = now == next ? previous : now;
      if (now == next) string[length++] = 0;
      for (; walk >= clear; walk = before[static_cast<std::size_t>(walk)])
        string[length++] = last[static_cast<std::size_t>(walk)];
      string[length++] = static_cast<std::uint8_t>(walk);
      if (now == next) string[0] = static_cast<std::uint8_t>(walk);
      if (previous >= 0 && next < 4096) {
        before[static_cast<std::size_t>(next)] = static_cast<std::uint16_t>(previous);
        last[static_cast<std::size_t>(next)] = static_cast<std::uint8_t>(walk);
        ++next;
        if (next == 1 << size && size < 12) ++size;
      }
      previous = now;
      while (length > 0 && done < wanted) put(frame, done++, string[--length]);
    }
  }

  void put(const Frame& frame, std::uint64_t place, std::uint8_t index) {
    const auto column = static_cast<std::uint32_t>(place % frame.width);
    const auto line = static_cast<std::uint32_t>(place / frame.width);
    const std::uint32_t row = frame.interlaced ? row_of(line, frame.height) : line;
    if (static_cast<int>(index) == transparent_) return;
    if (index >= color_count_) throw Damaged{fmt::format("unknown colour {}", index)};
    const std::uint64_t pixel = std::uint64_t{frame.top + row} * out_.width + frame.left + column;
    std::memcpy(out_.rgba.data() + 4 * pixel, bytes_.data() + colors_ + 3 * std::size_t{index}, 3);
    out_.rgba[4 * pixel + 3] = 255;
  }

  // Rows of an interlaced image come as each 8th from 0, from 4, each 4th from 2, each 2nd
  // from 1.
  static std::uint32_t row_of(std::uint32_t line, std::uint32_t height) {
    constexpr std::uint32_t kPasses[][2] = {{0, 8}, {4, 8}, {2, 4}, {1, 2}};
    for (const auto& [first, step] : kPasses) {
      const std::uint32_t rows = height > first ? (height - first + step - 1) / step : 0;
      if (line < rows) return first + line * step;
      line -= rows;
    }
    return 0;
  }

  std::span<const std::byte> bytes_;
  std::uint64_t max_bytes_;
  DecodedImage& out_;
  std::size_t at_ = 0;
  std::size_t colors_ = 0;  // place of the table
  std::size_t color_count_ = 0;
  int transparent_ = -1;
  unsigned bits_ = 0;
  unsigned bit_count_ = 0;
  unsigned in_block_ = 0;  // bytes left
};

}  // namespace

bool is_gif(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.starts_with("GIF87a") || text.starts_with("GIF89a");
}

ImageProblem decode_gif(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                        DecodedImage& out) {
  out = {};
  return GifReader(bytes, max_bytes, out).run();
}

}  // namespace panwright::image
