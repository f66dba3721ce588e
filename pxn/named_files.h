// Files named by a pxn text.
#pragma once

#include <filesystem>
#include <string_view>

#include "base/file_uses.h"

namespace panwright::pxn {

// Declares as inputs of a run all files beside a text named in its attributes and element texts,
// even unread ones: no output may replace them. Everything that looks like a file name counts, also
// in texts that are not well-formed.
//
//   path  of the text: names are relative to its folder
// Cost: O(bytes), and a look at the disk for each of at most 10,000 names.
void declare_named_files(const std::filesystem::path& path, std::string_view text, FileUses& files);

}  // namespace panwright::pxn
