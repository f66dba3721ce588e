// Request to panwright-gdal, and its answer: a header line of JSON-free text, then rows. Private to
// terrain.
//
// Request: "path\nband\nfirst\ncount\nlibrary\n". Answer: kGdalMark, lines "key value" that end in
// an empty line, then count·width doubles of this processor. A line "error TEXT" ends it.
#pragma once

#include <string_view>

namespace panwright::terrain {

inline constexpr std::string_view kGdalMark = "panwright-gdal 1\n";
inline constexpr const char* kGdalVariable = "PANWRIGHT_GDAL";

}  // namespace panwright::terrain
