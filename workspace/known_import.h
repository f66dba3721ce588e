// Cache of pan files of CAD imports between runs.
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

// Results of write_pan().
struct KnownImport {
  compiler::Report report;  // without parts, fit and times
  std::optional<compiler::HiddenReport> hidden;
};

// Pan file of one import, keyed by a hash of the file, the options and the program. Only for
// self-contained GLB files: for others the searched paths are not all known. Parts of other imports
// may be cached (base/work_cache.h).
class ImportMemory {
 public:
  // path, options, write: as of read_cad() and write_pan(). log: its present entries are not
  // stored.
  ImportMemory(const std::filesystem::path& path, const OpenOptions& options,
               const WriteOptions& write, const DiagnosticLog& log);

  // Writes the same file as before, unless it exists, and repeats its diagnostics. Nothing: not
  // cached, or, reported as E0103, not writable.
  std::optional<KnownImport> recall(DiagnosticLog& log, OpenReport* report) const;

  // Stores the written output, and the present log.
  void keep(const scene::Scene& scene, const KnownImport& made, const DiagnosticLog& log) const;

 private:
  std::optional<WorkCache> cache_;  // none: the import is not cacheable
  Hash128 key_;
  Hash128 file_;        // of its bytes
  std::string origin_;  // WriteOptions::origin
  std::filesystem::path output_;
  std::size_t said_ = 0;  // earlier entries of the log
};

}  // namespace panwright::workspace
