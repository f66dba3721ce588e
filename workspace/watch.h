// Files that are looked at for changes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <vector>

#include "base/diagnostic.h"
#include "pan/model.h"

namespace panwright::workspace {

// What tells a file from an earlier one of its name.
struct FileStamp {
  std::filesystem::path path;
  std::int64_t time = 0;
  std::int64_t size = -1;  // −1: not there
  std::uint64_t inode = 0;
  bool operator==(const FileStamp&) const = default;
};
FileStamp stamp_of(const std::filesystem::path& path);
std::vector<FileStamp> stamps_of(const std::vector<FileStamp>& files);

// Whether a file is another one than it was. Then it waits until all stay as they are for 30 ms, as editors
// write in several steps, and `known` is how they are now.
bool have_changed(std::vector<FileStamp>& known);
void wait_until_still(std::vector<FileStamp>& known);  // the second half of it

// Adds what a model was made from, beside the file `path`; and what diagnostics speak of.
void add_inputs(const pan::Model& model, const std::filesystem::path& path, std::set<std::filesystem::path>& files);
void add_sources(const DiagnosticLog& log, std::set<std::filesystem::path>& files);

}  // namespace panwright::workspace
