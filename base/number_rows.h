// Rows of numbers in texts and files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"

namespace panwright {

// Returns the finite numbers of a line, between spaces, commas or semicolons; none: a word is not
// one.
std::optional<std::vector<double>> numbers_in(std::string_view line);

// Reads a file of rows: returns `columns` numbers of each line, one row after the other. Further
// columns are ignored, `#` begins a comment, empty lines count not, and a first line that is not of
// numbers is a heading.
//
//   code  of lines with fewer or other words, and of more than 10 million rows
// Fails: E0101, E0102, E0104 over 1 GiB; code.
Result<std::vector<double>> read_number_rows(const std::filesystem::path& path, std::size_t columns,
                                             Code code, DiagnosticLog& log);

}  // namespace panwright
