// Numbers of TIFF files by rows, as maps of heights hold them, and what places them on a map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "image/decode.h"

namespace panwright::image {

struct TiffHead {
  enum class Sample : std::uint8_t { unsigned_integer, signed_integer, real };
  std::uint32_t width = 0, height = 0, bands = 1;
  Sample sample = Sample::unsigned_integer;
  unsigned bits = 8;  // 8, 16, 32 or 64
  bool big_endian = false;
  // tags of GeoTIFF; empty where the file has none
  std::vector<double> pixel_scale, tiepoint, transformation, geo_doubles;
  std::vector<std::uint16_t> geo_keys;
  std::string geo_ascii, gdal_metadata, no_data;
};

// Reads the head of a file.
//
// Problems: E3001.
ImageProblem read_tiff_head(std::span<const std::byte> bytes, TiffHead& head);

// Receiver of a row of numbers; returns whether more are wanted.
using NumbersReceiver = std::function<bool(std::uint32_t row, std::span<const double> values)>;

// Decodes rows [first, first + count) of a band (from 0), in memory of a row, or of the tiles
// beside each other: at most max_bytes. Strips that are not compressed take none.
//
// Problems: E3001, E3002. Expects: the head of these bytes, rows and a band in it.
ImageProblem decode_tiff_numbers(std::span<const std::byte> bytes, const TiffHead& head,
                                 std::uint32_t band, std::uint32_t first, std::uint32_t count,
                                 std::uint64_t max_bytes, const NumbersReceiver& to);

}  // namespace panwright::image
