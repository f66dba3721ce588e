// Watching of files for changes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "pan/model.h"

namespace panwright::workspace {

// Stamp that distinguishes versions of a file.
struct FileStamp {
  std::filesystem::path path;
  std::int64_t time = 0;
  std::int64_t size = -1;  // −1: missing
  std::uint64_t inode = 0;
  bool operator==(const FileStamp&) const = default;
};
FileStamp stamp_of(const std::filesystem::path& path);
std::vector<FileStamp> stamps_of(const std::vector<FileStamp>& files);

// Returns true if a file has changed. It then waits until all are stable for 30 ms, as editors
// write in several steps, or the job is cancelled, and updates `known`.
bool have_changed(std::vector<FileStamp>& known, const Job& job);
void wait_until_still(std::vector<FileStamp>& known, const Job& job);  // the second half of it

// Adds the inputs of a model besides the file `path`; and the files of diagnostics.
void add_inputs(const pan::Model& model, const std::filesystem::path& path,
                std::set<std::filesystem::path>& files);
void add_sources(const DiagnosticLog& log, std::set<std::filesystem::path>& files);

}  // namespace panwright::workspace
