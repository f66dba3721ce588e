// Files of the heights of foil sheets, for other programs.
#pragma once

#include <filesystem>
#include <string>

#include "base/diagnostic.h"
#include "mli/sheet.h"

namespace panwright::tools {

// Returns true for the extensions .npy, .exr, .png. Reports E0202.
bool is_height_file(const std::filesystem::path& path, DiagnosticLog& log);

// Writes the heights at the vertices in the format of the extension, atomically.
//
//   .npy  (rows, columns) float64, metres; row 0 is the sheet's lower edge, y = 0
//   .exr  R = G = B = metres, 32-bit float; the lower edge is the last row, as in an image
//   .png  16-bit grey, 0 the lowest and 65535 the highest height, rounded; rows as in .exr; a
//         comment has the scale
//
//   detail   set to a description of the file
//   returns  true if it was written
// Fails: E0202, E0103.
bool write_heights(const std::filesystem::path& path, const mli::Sheet& sheet, std::string& detail,
                   DiagnosticLog& log);

}  // namespace panwright::tools
