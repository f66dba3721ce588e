// The files that a pxn text names.
#pragma once

#include <filesystem>
#include <string_view>

#include "base/file_uses.h"

namespace panwright::pxn {

// Declares as inputs of a run all files beside a text that its attributes and element texts name,
// whether or not anything reads them: no output may take their place. Whatever looks like a file
// name counts, in texts that are not well-formed too.
//
//   path  of the text: names are relative to its folder
// Cost: O(bytes), and a look at the disk for each of at most 10,000 names.
void declare_named_files(const std::filesystem::path& path, std::string_view text, FileUses& files);

}  // namespace panwright::pxn
