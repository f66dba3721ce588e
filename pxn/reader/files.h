// Where included files come from: the disk, within a folder, or memory.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "base/result.h"
#include "pxn/pxn.h"

namespace panwright::pxn {

// A file that is there, and may be read.
struct FoundFile {
  std::string key;   // the same for every way to name it
  std::string name;  // as the user would type it
  std::string path;  // relative to the top file's folder, '/' between parts
};

class Files {
 public:
  enum class Outcome { found, missing, outside };

  virtual ~Files() = default;

  // Looks for a file as an include names it: from the top file's folder, then from the including
  // file's; with own_folder from the latter only. Nothing outside the root is looked at.
  virtual Outcome find(std::string_view file, const FoundFile& including, bool own_folder,
                       FoundFile& out) const = 0;

  // Names that stand in the folder in which `file` was looked for first, for a suggestion.
  virtual std::string near_name(std::string_view file, const FoundFile& including,
                                bool own_folder) const = 0;

  // Reads a file. All files together may have limits.bytes.
  //
  // Fails: E0101, E0102, E0104, at `where`.
  virtual Result<std::shared_ptr<const std::string>> load(const FoundFile& file, SourceSpan where,
                                                          DiagnosticLog& log) = 0;
};

// The top file of a reading from disk is found in any case; load says whether it is there.
std::unique_ptr<Files> files_on_disk(const std::filesystem::path& top, const Options& options,
                                     FoundFile& found_top);
std::unique_ptr<Files> files_in_memory(std::span<const MemoryFile> files, const Options& options,
                                       FoundFile& found_top);

}  // namespace panwright::pxn
