// Where a model and the files that it names come from: one folder on disk, or memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "base/source.h"

namespace panwright::importers {

struct MemoryFile {
  std::string path;  // relative, '/' between parts
  std::string bytes;
};

// Files below one folder. Paths are relative to it, in normal form, '/' between parts.
class Files {
 public:
  enum class Outcome {
    found,
    missing,    // nothing there, or not a regular file
    outside,    // a link leads out of the folder
    too_large,  // brings all files read so far to more than the limit
    unreadable,
  };

  virtual ~Files() = default;

  // Reads a file. Each reading counts towards the limit of bytes.
  virtual Outcome read(const std::string& path, SharedText& bytes) = 0;

  // The one file whose path differs from this in the case of letters alone.
  virtual std::optional<std::string> same_but_for_case(const std::string&) { return std::nullopt; }

  // Declares a file that the model names, whether or not anybody reads it: no output may take its
  // place (base/file_uses.h). As the model's folder sees it; it may lie outside, or not be there.
  virtual void declare(const std::string&) {}

  // As the user would type it.
  virtual std::string display_name(const std::string& path) const = 0;
};

// log: of the run, for the files that it watches. Files over 1 MB are mapped, so that what was read
// of them need not stay in memory. note: a file that another program cuts short while it is mapped
// ends the process with SIGBUS, as for any mapping; one that is replaced by rename stays whole.
std::unique_ptr<Files> files_in_folder(const std::filesystem::path& folder, std::uint64_t max_bytes,
                                       const DiagnosticLog& log);

// The bytes are not copied: they outlive the result.
std::unique_ptr<Files> files_in_memory(std::span<const MemoryFile> files, std::uint64_t max_bytes);

// The path that a URI or file name in the file `including` stands for: percent-decoded when asked,
// "file:" and backslashes taken as people mean them. Nothing when it leaves the folder, is
// absolute, names another scheme, or holds a NUL.
std::optional<std::string> resolved(std::string_view including, std::string_view uri,
                                    bool percent_encoded);

// Declares what a URI or file name in the file `including` stands for, if it is one of a file.
void declare(Files& files, std::string_view including, std::string_view uri, bool percent_encoded);

}  // namespace panwright::importers
