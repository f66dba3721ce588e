// Deduplication by hashing on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/parallel.h"

namespace panwright::geometry {

inline constexpr std::uint64_t kHashSeed = 0x9e3779b97f4a7c15ull;  // 2^64 / golden ratio

// multiply and fold: coordinates differ in few bits, often only the high ones
inline std::uint64_t hash_step(std::uint64_t h, std::uint64_t part) {
  h = (h ^ part) * 0xff51afd7ed558ccdull;  // MurmurHash3's 64-bit finaliser
  return h ^ (h >> 32);
}
inline std::uint64_t hash_end(std::uint64_t h) {
  h *= 0xc4ceb9fe1a85ec53ull;  // the same
  return h ^ (h >> 29);
}

namespace internal {

struct Hashed {
  std::uint32_t index;
  std::uint32_t hash;
};

// Fills one table with items in ascending order. False: too many collisions.
template <class Equal>
bool fill_table(const Hashed* items, std::size_t count, std::vector<std::uint32_t>& table,
                std::uint32_t* first, const Equal& equal) {
  constexpr std::uint32_t kEmpty = 0xffffffffu;
  const std::size_t slots = std::bit_ceil(std::max<std::size_t>(16, count * 2));
  table.assign(slots, kEmpty);
  // a sound table needs about 1.5 probes for each item; one under attack needs all of them
  std::uint64_t probes_left = 32 * static_cast<std::uint64_t>(count) + 1024;
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t slot = items[i].hash & (slots - 1);
    for (; table[slot] != kEmpty; slot = (slot + 1) & (slots - 1)) {
      if (--probes_left == 0) return false;
      const Hashed& other = items[table[slot]];
      if (other.hash == items[i].hash && equal(other.index, items[i].index)) break;
    }
    if (table[slot] == kEmpty) table[slot] = static_cast<std::uint32_t>(i);
    first[items[i].index] = items[table[slot]].index;
  }
  return true;
}

}  // namespace internal

// Returns for each of `count` items the first one equal to it, or nothing if too many hashes
// collide. hash(i) and equal(a, b) are called from any thread.
//
// Items are distributed by hash into buckets that fit a cache; each keeps the order of items.
// Cost: O(count).
template <class Hash, class Equal>
std::optional<std::vector<std::uint32_t>> deduplicate(std::size_t count, const Hash& hash,
                                                      const Equal& equal) {
  using internal::Hashed;
  constexpr std::size_t kChunk = 1u << 15;
  const std::size_t chunks = (count + kChunk - 1) / kChunk;
  const std::size_t buckets = std::min<std::size_t>(256, std::bit_ceil(chunks));
  std::vector<std::uint32_t> first(count);
  std::vector<Hashed> items(count);
  std::vector<std::uint64_t> hashes(count);
  std::vector<std::size_t> start(chunks * buckets + 1, 0);  // buckets first, then chunks
  const auto bucket_of = [&](std::uint64_t h) {
    return static_cast<std::size_t>(h >> 56) % buckets;
  };
  parallel_for(chunks, [&](std::size_t c) {
    const std::size_t end = std::min(count, (c + 1) * kChunk);
    for (std::size_t i = c * kChunk; i < end; ++i) {
      hashes[i] = hash(static_cast<std::uint32_t>(i));
      ++start[bucket_of(hashes[i]) * chunks + c + 1];
    }
  });
  for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
  parallel_for(chunks, [&](std::size_t c) {
    std::vector<std::size_t> at(buckets);
    for (std::size_t b = 0; b < buckets; ++b) at[b] = start[b * chunks + c];
    const std::size_t end = std::min(count, (c + 1) * kChunk);
    for (std::size_t i = c * kChunk; i < end; ++i)
      items[at[bucket_of(hashes[i])]++] = {static_cast<std::uint32_t>(i),
                                           static_cast<std::uint32_t>(hashes[i])};
  });
  hashes = std::vector<std::uint64_t>();
  std::atomic<bool> sound = true;
  if (count > 0)
    parallel_for(buckets, [&](std::size_t b) {
      std::vector<std::uint32_t> table;
      const std::size_t begin = start[b * chunks];
      if (!internal::fill_table(items.data() + begin, start[(b + 1) * chunks] - begin, table,
                                first.data(), equal))
        sound = false;
    });
  if (!sound) return std::nullopt;
  return first;
}

}  // namespace panwright::geometry
