// Source of a model and of the files that it names: one folder on disk, or memory.
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

// Files below one folder. Paths are relative to the model's folder, which is that one or lies in
// it, in normal form, '/' between parts.
class Files {
 public:
  enum class Outcome {
    found,
    missing,    // nothing there, or not a regular file
    outside,    // the path, or a link on it, leads out of the folder
    too_large,  // exceeds the limit of all files together
    unreadable,
  };

  virtual ~Files() = default;

  // Reads a file. Each reading counts towards the limit of bytes.
  virtual Outcome read(const std::string& path, SharedText& bytes) = 0;

  // Returns the one file whose path differs only in letter case.
  virtual std::optional<std::string> same_but_for_case(const std::string&) { return std::nullopt; }

  // Declares a file named by the model, even if unread: no output may replace it
  // (base/file_uses.h). Relative to the model's folder; it may lie outside, or be missing.
  virtual void declare(const std::string&) {}

  // Returns the path of an absolute one; it may lie outside. Nothing: there are none.
  virtual std::optional<std::string> relative(const std::string&) const { return std::nullopt; }

  // Returns the path for messages.
  virtual std::string display_name(const std::string& path) const = 0;
};

// Opens a folder. log: of the run, for file tracking. Files over 1 MB are mapped, so that bytes
// already read need not stay in memory. note: a mapped file that another program truncates ends the
// process with SIGBUS; one replaced by rename stays whole.
//
//   model  path of the file that the user names: a link that leads out of the folder is followed
std::unique_ptr<Files> files_in_folder(const std::filesystem::path& folder, std::uint64_t max_bytes,
                                       const DiagnosticLog& log, const std::string& model = {});

// Opens files in memory. The bytes are not copied and must outlive the result.
std::unique_ptr<Files> files_in_memory(std::span<const MemoryFile> files, std::uint64_t max_bytes);

// Resolves a URI or file name in the file `including`: percent-decoded on request, "file:" and
// backslashes accepted. It may lead out of the folder. Nothing if it is absolute, names another
// scheme, or holds a NUL.
std::optional<std::string> resolved(std::string_view including, std::string_view uri,
                                    bool percent_encoded);

// Returns a URI or file name as a path: '/' between parts, no "file:".
std::string path_in(std::string_view uri, bool percent_encoded);

// Returns true for a path of one machine: "/cad/m.obj", "C:/cad/m.obj".
bool is_absolute(std::string_view path);

// Declares the target of a URI or file name in the file `including`, if it is a file.
void declare(Files& files, std::string_view including, std::string_view uri, bool percent_encoded);

}  // namespace panwright::importers
