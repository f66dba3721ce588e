// Results of long work, kept between runs: a folder with one file per result.
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

// A cache never decides whether work succeeds: what cannot be read is not there, what cannot be
// written is not kept, and nothing is reported. Any number of threads and processes may use one
// folder: entries appear whole, and are checked when they are read. Files of other users are not
// read.
class FileCache {
 public:
  // folder: it and the folders above it are made, for this user alone, when something is kept.
  // max_bytes: of all entries, each counted as 4 KiB at least. Above it, those go that were used
  // longest ago.
  explicit FileCache(std::filesystem::path folder, std::uint64_t max_bytes = 256ull << 20);

  // Returns what was kept under a key; none: nothing, or not whole.
  std::optional<std::vector<std::byte>> find(const Hash128& key) const;

  // key: of everything that the result follows from, the version of the work included.
  // An entry of more than half of max_bytes is not kept. Cost: a look at every entry's size at
  // first, and wherever the folder may have become too large. With several processes it may be
  // above max_bytes by what 64 entries of each take, until one of them looks.
  void keep(const Hash128& key, std::span<const std::byte> entry) const;

 private:
  void make_room() const;
  std::filesystem::path folder_;
  std::uint64_t max_bytes_;
  mutable std::atomic<std::uint64_t> sum_;       // of all entries; not known: max_bytes_
  mutable std::atomic<std::uint64_t> kept_ = 0;  // entries of this object
};

}  // namespace panwright
