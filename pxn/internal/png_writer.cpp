#include "pxn/internal/png_writer.h"

#include <zlib.h>

#include <cassert>
#include <string_view>
#include <vector>

namespace panwright::pxn {

namespace {

void append_big_endian(std::string& out, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<char>(value >> shift & 0xff));
}

void append_chunk(std::string& out, std::string_view type, std::string_view data) {
  append_big_endian(out, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = out.size();
  out += type;
  out += data;
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(out.data() + begin),
                         static_cast<uInt>(out.size() - begin));
  append_big_endian(out, static_cast<std::uint32_t>(sum));
}

}  // namespace

std::string png_file(std::uint32_t width, std::uint32_t height,
                     std::span<const std::uint8_t> rgba) {
  const std::size_t row = std::size_t{4} * width;
  assert(rgba.size() == row * height);
  std::vector<std::uint8_t> rows;
  rows.reserve((row + 1) * height);
  for (std::uint32_t y = 0; y < height; ++y) {
    // texels less those to their left: filter 1 of the PNG specification
    rows.push_back(1);
    const auto line = rgba.subspan(row * y, row);
    for (std::size_t i = 0; i < row; ++i)
      rows.push_back(static_cast<std::uint8_t>(line[i] - (i < 4 ? 0 : line[i - 4])));
  }
  uLongf size = compressBound(static_cast<uLong>(rows.size()));
  std::string packed(size, '\0');
  [[maybe_unused]] const int status =
      compress2(reinterpret_cast<Bytef*>(packed.data()), &size, rows.data(),
                static_cast<uLong>(rows.size()), Z_DEFAULT_COMPRESSION);
  assert(status == Z_OK);
  packed.resize(size);

  std::string out("\x89PNG\r\n\x1a\n", 8);
  std::string header;
  append_big_endian(header, width);
  append_big_endian(header, height);
  // 8 bits a channel, RGBA, deflate, no interlacing
  header += std::string("\x08\x06\0\0\0", 5);
  append_chunk(out, "IHDR", header);
  append_chunk(out, "IDAT", packed);
  append_chunk(out, "IEND", {});
  return out;
}

}  // namespace panwright::pxn
