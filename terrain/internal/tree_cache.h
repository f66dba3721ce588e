// Trees of tiles that rays have come to, in bounded memory. Private to terrain.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <vector>

#include "terrain/internal/tile_tree.h"

namespace panwright::terrain::internal {

class TreeCache {
 public:
  // most: bytes, above which trees are dropped while none is in use.
  TreeCache(const Tiles& tiles, std::size_t most);
  ~TreeCache();

  // Keeps trees in place while it lives, on one thread; some thousand rays long. Within another of
  // the same trees it does nothing.
  class Use {
   public:
    explicit Use(TreeCache& trees);
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    TreeCache& trees_;
  };

  // Tree of a tile, made at the first call. Expects: a Use of this thread. Thread-safe.
  const TileTree& of(std::uint32_t tile, const ChartSurface& surface);
  std::size_t bytes() const { return bytes_.load(); }

 private:
  struct Slot {
    std::atomic<const TileTree*> tree{nullptr};
    std::atomic<std::uint32_t> used{0};
  };
  struct Held;
  static thread_local std::vector<Held> held_;
  void make(std::uint32_t tile, const ChartSurface& surface);
  void drop();

  const Tiles& tiles_;
  const std::size_t most_;
  std::unique_ptr<Slot[]> slots_;
  // threads share few locks, so that they do not wait for one another's cache line
  struct alignas(64) Lock {
    std::shared_mutex mutex;
  };
  Lock in_use_[16];
  std::mutex making_[16];
  std::atomic<std::size_t> bytes_{0};
  std::atomic<std::uint32_t> turn_{0};  // counts drops, for the age of trees
};

}  // namespace panwright::terrain::internal
