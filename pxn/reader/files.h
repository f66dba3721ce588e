// Source of included files: the disk, within a folder, or memory.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "base/result.h"
#include "pxn/pxn.h"

namespace panwright::pxn {

// Existing and permitted file.
struct FoundFile {
  std::string key;   // the same for all its names
  std::string name;  // for messages
  std::string path;  // relative to the top file's folder, '/' between parts
};

class Files {
 public:
  enum class Outcome { found, missing, outside };

  virtual ~Files() = default;

  // Finds a file named by an include: from the top file's folder, then from the including file's;
  // with own_folder from the latter only. Never searches outside the root.
  virtual Outcome find(std::string_view file, const FoundFile& including, bool own_folder,
                       FoundFile& out) const = 0;

  // Returns the one file whose path, from the including file's folder, differs in letter case
  // alone.
  virtual std::optional<std::string> same_but_for_case(const std::string& file,
                                                       const FoundFile& including) = 0;

  // Returns similar names in the first searched folder, for a suggestion.
  virtual std::string near_name(std::string_view file, const FoundFile& including,
                                bool own_folder) const = 0;

  // Reads a file, within limits.bytes of all files together.
  //
  // Fails: E0101, E0102, E0104, at `where`.
  virtual Result<std::shared_ptr<const std::string>> load(const FoundFile& file, SourceSpan where,
                                                          DiagnosticLog& log) = 0;
};

// Opens a folder on disk. The top file is always found; load() reports if it is missing.
std::unique_ptr<Files> files_on_disk(const std::filesystem::path& top, const Options& options,
                                     FoundFile& found_top);
std::unique_ptr<Files> files_in_memory(std::span<const MemoryFile> files, const Options& options,
                                       FoundFile& found_top);

}  // namespace panwright::pxn
