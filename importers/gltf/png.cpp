#include "importers/gltf/png.h"

#include <png.h>

#include <cstdlib>
#include <cstring>

namespace panwright::importers::gltf {

namespace {

void append(png_structp png, png_bytep data, std::size_t size) {
  auto& out = *static_cast<std::vector<std::byte>*>(png_get_io_ptr(png));
  const std::size_t at = out.size();
  out.resize(at + size);
  std::memcpy(out.data() + at, data, size);
}

void flush(png_structp) {}

// libpng may not return from here, and finds nothing wrong with what it is given below
void stop(png_structp, png_const_charp) { std::abort(); }
void ignore(png_structp, png_const_charp) {}

}  // namespace

std::vector<std::byte> png_of(std::span<const std::uint8_t> rgba, std::uint32_t width,
                              std::uint32_t height) {
  bool opaque = true;
  for (std::size_t i = 3; i < rgba.size(); i += 4) opaque = opaque && rgba[i] == 255;
  std::vector<std::byte> out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, stop, ignore);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &out, append, flush);
  png_set_IHDR(png, info, width, height, 8, opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(png, 6);
  png_write_info(png, info);
  const std::size_t channels = opaque ? 3 : 4;
  std::vector<std::uint8_t> row(channels * width);
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* from = rgba.data() + y * width * 4;
    for (std::size_t x = 0; x < width; ++x)
      for (std::size_t k = 0; k < channels; ++k) row[x * channels + k] = from[x * 4 + k];
    png_write_row(png, row.data());
  }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

}  // namespace panwright::importers::gltf
