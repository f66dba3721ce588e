// Checksum of sections and of the directory: a hash of the hashes of blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/hash.h"
#include "schemas/generated/pan_layout.h"

namespace panwright::pan::internal {

inline std::uint64_t block_count(std::uint64_t bytes) {
  return bytes / layout::kHashBlock + (bytes % layout::kHashBlock != 0);
}

inline std::span<const std::byte> block(std::span<const std::byte> bytes, std::uint64_t index) {
  const std::uint64_t begin = index * layout::kHashBlock;
  return bytes.subspan(begin, std::min<std::uint64_t>(layout::kHashBlock, bytes.size() - begin));
}

inline std::uint64_t combined(const std::vector<std::uint64_t>& block_hashes) {
  return hash64(std::as_bytes(std::span(block_hashes)));
}

inline std::uint64_t block_hash(std::span<const std::byte> bytes) {
  std::vector<std::uint64_t> hashes(block_count(bytes.size()));
  for (std::size_t i = 0; i < hashes.size(); ++i) hashes[i] = hash64(block(bytes, i));
  return combined(hashes);
}

// The header's checksum: of the bytes before the field itself.
inline std::uint64_t header_hash(const layout::Header& header) {
  return hash64(std::as_bytes(std::span(&header, 1)).first(offsetof(layout::Header, header_hash)));
}

}  // namespace panwright::pan::internal
