// Cache of results of long work between runs: a folder with one file per result.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "base/hash.h"

namespace panwright {

// Cache of files. It never decides whether work succeeds: unreadable entries count as absent,
// unwritable ones are dropped, and nothing is reported. Any number of threads and processes may
// share one folder: entries appear whole and are checked when read. Files of other users are not
// read.
class FileCache {
 public:
  // folder: made with its parents, for this user alone, at the first entry. max_bytes: of all
  // entries, each counted as 4 KiB at least; beyond it the least recently used are removed.
  explicit FileCache(std::filesystem::path folder, std::uint64_t max_bytes = 256ull << 20);

  // Returns the entry of a key; none: absent or not whole.
  std::optional<std::vector<std::byte>> find(const Hash128& key) const;

  // Stores an entry. key: of everything the result depends on, the version of the work included. An
  // entry above half of max_bytes is not kept. Cost: reads every entry's size at first, and when
  // the folder may be too large. Each further process may exceed max_bytes by 64 entries until one
  // of them checks.
  void keep(const Hash128& key, std::span<const std::byte> entry) const;

 private:
  void make_room() const;
  std::filesystem::path folder_;
  std::uint64_t max_bytes_;
  mutable std::atomic<std::uint64_t> sum_;       // of all entries; unknown: max_bytes_
  mutable std::atomic<std::uint64_t> kept_ = 0;  // entries of this object
};

}  // namespace panwright
