// Header of NPY files.
#pragma once

#include <string>
#include <string_view>

namespace panwright::image {

// Returns the bytes before the data, in format 1.0 of numpy.lib.format.
//
//   type   of an element, as "<f4"
//   shape  a Python tuple, as "(480, 640, 3)"
std::string npy_header(std::string_view type, std::string_view shape);

}  // namespace panwright::image
