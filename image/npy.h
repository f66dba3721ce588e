// NPY files: their header, and their length.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace panwright::image {

// Returns the bytes before the data, in format 1.0 of numpy.lib.format.
//
//   type   of an element, as "<f4"
//   shape  a Python tuple, as "(480, 640, 3)"
std::string npy_header(std::string_view type, std::string_view shape);

// Returns whether a file of that format is as long as its header says.
bool is_whole_npy(std::span<const std::byte> file);

}  // namespace panwright::image
