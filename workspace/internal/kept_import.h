// CAD files that an earlier run compiled. Private to workspace.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/file.h"
#include "base/work_cache.h"
#include "workspace/open.h"

namespace panwright::workspace {

// The pan and the diagnostics of one CAD file, by its bytes and all options. Kept only where they
// depend on no other file: neither one that was read, nor one that was missing.
class KeptImport {
 public:
  // cache: null: none. Expects: options, cache and log outlive this.
  KeptImport(const std::filesystem::path& path, const OpenOptions& options, const WorkCache* cache,
             DiagnosticLog& log);

  // Returns the pan, unverified. Nothing: it is not kept.
  std::optional<std::vector<std::byte>> find();

  // Reports the diagnostics of the pan that find() returned.
  void report_again();

  // Keeps a pan and what the log has had since the constructor.
  void keep(const pan::Model& model) const;

 private:
  // Diagnostic of an earlier run.
  struct Entry {
    Diagnostic said;
    FileId file = kNoFile;  // then
    SourceFile source;
    bool is_text = false;
  };
  std::optional<std::vector<std::byte>> diagnostics() const;  // none: they name other texts
  bool read_diagnostics(std::span<const std::byte> bytes);
  FileId file_of(const Entry& entry);  // in the log

  std::filesystem::path path_;
  const WorkCache* cache_;
  DiagnosticLog& log_;
  std::optional<MappedFile> file_;
  Hash128 key_;
  std::size_t entries_ = 0;  // of the log, before
  std::size_t hidden_ = 0;
  std::size_t errors_ = 0;
  std::vector<Entry> found_;
  std::shared_ptr<const std::string> text_;  // of the file, where an entry has a place in it
};

}  // namespace panwright::workspace
