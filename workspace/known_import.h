// CAD files whose pan file an earlier run has made.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/diagnostic.h"
#include "base/hash.h"
#include "base/work_cache.h"
#include "scene/scene.h"
#include "workspace/open.h"

namespace panwright::workspace {

// What write_pan() said of it.
struct KnownImport {
  compiler::Report report;  // without parts, fit and times
  std::optional<compiler::HiddenReport> hidden;
};

// The pan file of one import, under a hash of the file, the options and the program. Of GLB files
// that hold all that they need: of others not all that they were looked for in is known. Where
// nothing is known, parts may be (base/work_cache.h).
class ImportMemory {
 public:
  // path, options, write: as read_cad() and write_pan() are given them. log: what it holds by now
  // is not part of what is kept.
  ImportMemory(const std::filesystem::path& path, const OpenOptions& options,
               const WriteOptions& write, const DiagnosticLog& log);

  // Writes the same file as before, unless it is there, and says again what was said. Nothing: it
  // is not known, or, reported as E0103, cannot be written.
  std::optional<KnownImport> recall(DiagnosticLog& log, OpenReport* report) const;

  // Keeps what was written to the output, and what the log says now.
  void keep(const scene::Scene& scene, const KnownImport& made, const DiagnosticLog& log) const;

 private:
  std::optional<WorkCache> cache_;  // none: this import is not for it
  Hash128 key_;
  Hash128 file_;        // of its bytes
  std::string origin_;  // WriteOptions::origin
  std::filesystem::path output_;
  std::size_t said_ = 0;  // entries of the log before
};

}  // namespace panwright::workspace
