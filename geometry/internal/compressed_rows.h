// Compressed rows: numbers grouped by a key.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace panwright::geometry {

// Compressed rows (CSR): the items of key k are items[start[k], start[k + 1]), in ascending order.
struct CompressedRows {
  std::vector<std::uint32_t> start;  // keys + 1
  std::vector<std::uint32_t> items;
  std::span<const std::uint32_t> operator[](std::size_t key) const {
    return std::span(items).subspan(start[key], start[key + 1] - start[key]);
  }
};

inline constexpr std::uint32_t kNoKey = 0xffffffffu;

// Sorts the numbers from 0 to keys.size() − 1 by their key; those with kNoKey are in no row.
//
//   keys   each < count, or kNoKey
//   Cost: O(items + count), on several threads.
CompressedRows compressed_rows_by(std::span<const std::uint32_t> keys, std::size_t count);

}  // namespace panwright::geometry
