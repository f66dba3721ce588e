// Archives of arrays as numpy reads and writes them (.npz), and the depth of rendered images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"

namespace panwright::image {

// Array in C order, little-endian.
struct Array {
  std::string name;                  // without ".npy"
  std::string type;                  // of an element, as "|u1", "<f4"
  std::vector<std::uint64_t> shape;  // slowest index first
  std::vector<std::byte> data;
};

// Writes an archive, deflated, atomically. The bytes depend on the arrays and the version of zlib
// alone. The seconds spent in fsync are added to *sync_seconds when given.
//
// Expects: data of the shape. Fails: E0103.
bool write_arrays(const std::filesystem::path& path, std::span<const Array> arrays,
                  DiagnosticLog& log, double* sync_seconds = nullptr);

// Reads arrays of an archive, stored or deflated. Sizes are checked before anything is allocated,
// and checksums after.
//
//   names      those to read; empty: all. Absent ones are left out of the result
//   max_bytes  of all arrays read
//   returns    in the order of the archive
// Fails: E0101, E0104; E0102 for damaged archives and forms that this program does not write.
Result<std::vector<Array>> read_arrays(const std::filesystem::path& path,
                                       std::span<const std::string_view> names,
                                       std::uint64_t max_bytes, DiagnosticLog& log);

// Reads the depth of an image of .npz or .exr: width*height metres along the boresight, row 0 the
// top row, background +inf.
//
//   returns  empty: the file has none
// Fails: E0101, E0104; E0102 for damaged files and other sizes.
Result<std::vector<float>> read_depth(const std::filesystem::path& path, std::uint32_t width,
                                      std::uint32_t height, DiagnosticLog& log);

}  // namespace panwright::image
