#include "geometry/internal/weld.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

namespace panwright::geometry {

namespace {

using Key = std::array<std::uint64_t, 3>;

Key key_of(const Vec3& p) {
  // note: adding zero turns −0 into 0
  return {std::bit_cast<std::uint64_t>(p.x + 0.0), std::bit_cast<std::uint64_t>(p.y + 0.0),
          std::bit_cast<std::uint64_t>(p.z + 0.0)};
}

// multiply and fold: coordinates differ in few bits, often only the high ones
std::uint64_t mixed(const Key& key) {
  std::uint64_t h = 0x9e3779b97f4a7c15ull;  // 2^64 / golden ratio
  for (const std::uint64_t part : key) {
    h = (h ^ part) * 0xff51afd7ed558ccdull;  // MurmurHash3's 64-bit finaliser
    h ^= h >> 32;
  }
  h *= 0xc4ceb9fe1a85ec53ull;  // the same
  return h ^ (h >> 29);
}

}  // namespace

std::vector<std::uint32_t> welded_by_sorting(std::span<const Vec3> positions) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Key ka = key_of(positions[a]);
    const Key kb = key_of(positions[b]);
    return ka != kb ? ka < kb : a < b;
  });
  std::vector<std::uint32_t> first(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key_of(positions[order[i]]) == key_of(positions[order[i - 1]]);
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

std::vector<std::uint32_t> welded(std::span<const Vec3> positions) {
  constexpr std::uint32_t kEmpty = 0xffffffffu;
  const std::size_t slots = std::bit_ceil(std::max<std::size_t>(16, positions.size() * 2));
  std::vector<std::uint32_t> table(slots, kEmpty);
  std::vector<std::uint32_t> first(positions.size());
  // a sound table needs about 1.5 probes for each vertex; one that was attacked needs V
  std::uint64_t probes_left = 32 * static_cast<std::uint64_t>(positions.size()) + 1024;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Key key = key_of(positions[i]);
    std::size_t slot = mixed(key) & (slots - 1);
    while (table[slot] != kEmpty && key_of(positions[table[slot]]) != key) {
      if (--probes_left == 0) return welded_by_sorting(positions);
      slot = (slot + 1) & (slots - 1);
    }
    if (table[slot] == kEmpty) table[slot] = static_cast<std::uint32_t>(i);
    first[i] = table[slot];
  }
  return first;
}

}  // namespace panwright::geometry
