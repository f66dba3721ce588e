// Cache of one step, and its statistics. Private to workspace.
#pragma once

#include <optional>

#include "base/work_cache.h"
#include "workspace/open.h"

namespace panwright::workspace {

// Scope that adds its reused and computed results to a report, if there is one.
class KeptWork {
 public:
  KeptWork(const OpenOptions& options, OpenReport* report) : report_(report) {
    if (!options.cache.empty()) cache_.emplace(options.cache / "work");
  }
  ~KeptWork() {
    if (report_ != nullptr && cache_) report_->work.add(cache_->counts());
  }
  KeptWork(const KeptWork&) = delete;
  KeptWork& operator=(const KeptWork&) = delete;

  const WorkCache* cache() const { return cache_ ? &*cache_ : nullptr; }  // null: none

 private:
  OpenReport* report_;
  std::optional<WorkCache> cache_;
};

}  // namespace panwright::workspace
