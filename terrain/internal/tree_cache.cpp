#include "terrain/internal/tree_cache.h"

#include <algorithm>
#include <vector>

namespace panwright::terrain::internal {

TreeCache::TreeCache(const Tiles& tiles, std::size_t most)
    : tiles_(tiles), most_(most), slots_(new Slot[tiles.records().size()]) {}

TreeCache::~TreeCache() {
  for (std::size_t i = 0; i < tiles_.records().size(); ++i) delete slots_[i].tree.load();
}

namespace {

// Number of the thread, from 0.
std::size_t thread_number() {
  static std::atomic<std::size_t> threads{0};
  thread_local const std::size_t number = threads++;
  return number;
}

}  // namespace

// Caches that the thread uses, and how often.
struct TreeCache::Held {
  const TreeCache* trees;
  std::size_t count;
};
thread_local std::vector<TreeCache::Held> TreeCache::held_;

TreeCache::Use::Use(TreeCache& trees) : trees_(trees) {
  for (Held& held : held_)
    if (held.trees == &trees_) {
      ++held.count;
      return;
    }
  trees_.in_use_[thread_number() % std::size(trees.in_use_)].mutex.lock_shared();
  held_.push_back({&trees_, 1});
}

TreeCache::Use::~Use() {
  const auto held = std::ranges::find(held_, &trees_, &Held::trees);
  if (--held->count > 0) return;
  held_.erase(held);
  trees_.in_use_[thread_number() % std::size(trees_.in_use_)].mutex.unlock_shared();
  if (trees_.bytes_.load(std::memory_order_relaxed) > trees_.most_) trees_.drop();
}

const TileTree& TreeCache::of(std::uint32_t tile, const ChartSurface& surface) {
  Slot& slot = slots_[tile];
  const TileTree* tree = slot.tree.load(std::memory_order_acquire);
  if (tree == nullptr) {
    make(tile, surface);
    tree = slot.tree.load(std::memory_order_acquire);
  }
  const std::uint32_t turn = turn_.load(std::memory_order_relaxed);
  if (slot.used.load(std::memory_order_relaxed) != turn)
    slot.used.store(turn, std::memory_order_relaxed);
  return *tree;
}

void TreeCache::make(std::uint32_t tile, const ChartSurface& surface) {
  const std::lock_guard lock(making_[tile % std::size(making_)]);
  Slot& slot = slots_[tile];
  if (slot.tree.load(std::memory_order_relaxed) != nullptr) return;
  const auto view = tiles_.view(tile);
  auto tree =
      view ? std::make_unique<const TileTree>(surface, *view) : std::make_unique<const TileTree>();
  bytes_ += tree->bytes();
  slot.tree.store(tree.release(), std::memory_order_release);
}

// Drops the trees that were not used for longest, until three quarters are left.
void TreeCache::drop() {
  std::vector<std::unique_lock<std::shared_mutex>> alone;
  for (Lock& lock : in_use_) alone.emplace_back(lock.mutex);
  if (bytes_.load() <= most_) return;
  std::vector<std::uint32_t> made;
  for (std::uint32_t i = 0; i < tiles_.records().size(); ++i)
    if (slots_[i].tree.load() != nullptr) made.push_back(i);
  std::ranges::stable_sort(made, {}, [&](std::uint32_t i) { return slots_[i].used.load(); });
  for (const std::uint32_t i : made) {
    if (bytes_.load() <= most_ / 4 * 3) break;
    const std::unique_ptr<const TileTree> tree(slots_[i].tree.exchange(nullptr));
    bytes_ -= tree->bytes();
  }
  ++turn_;
}

}  // namespace panwright::terrain::internal
