// Compressed sections (docs/pan-format.md, Compression): independent chunks of a hash block's
// length, packed and unpacked by several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "schemas/generated/pan_layout.h"

namespace panwright::pan::internal {

// Byte length of a section in the file with its padding: plain, and compressed.
//
// Expects: lengths that a file of real bytes can have, so that no sum overflows.
std::uint64_t plain_stored_length(std::uint64_t raw_length);
std::uint64_t packed_stored_length(std::uint64_t packed_length, std::uint64_t raw_length);

// Returns the byte stride of a section's planes: of an element, of three short indices, of a texel.
std::uint32_t plane_count(std::uint32_t kind, std::uint32_t stride);

// Compresses a section: its chunks, then a word for each. The same bytes whatever the number of
// threads.
//
//   planes   plane_count() of the section
//   returns  nothing where compression gains less than an eighth, or raw is short
//
// Cost: O(raw); memory for the result, and for a few chunks a thread.
std::vector<std::byte> pack_section(std::span<const std::byte> raw, std::uint32_t planes);

// Chunks of a compressed section.
class PackedChunks {
 public:
  // Nothing when the lengths of the chunks do not add up to the section.
  //
  //   packed  the section's bytes in the file, packed_length of them
  // Cost: O(chunks). Expects: raw_length > 0.
  static std::optional<PackedChunks> of(std::span<const std::byte> packed, std::uint32_t planes,
                                        std::uint64_t raw_length);

  std::size_t count() const { return chunks_.size(); }
  // Offset of a chunk in the decompressed section, bytes.
  std::uint64_t begin(std::size_t chunk) const { return chunk * layout::kHashBlock; }
  std::uint64_t end(std::size_t chunk) const;

  // Decompresses one chunk to its offset in a section of raw_length bytes. Several threads may
  // decompress different chunks.
  //
  // returns  true if the chunk is valid; else its bytes are undefined
  // Cost: O(bytes of the chunk, packed and unpacked), for any bytes.
  bool unpack(std::size_t chunk, std::span<std::byte> section) const;

 private:
  struct Chunk {
    std::uint64_t offset;  // in packed_
    std::uint32_t length;
    std::uint32_t form;
  };
  std::span<const std::byte> packed_;
  std::uint32_t planes_ = 1;
  std::uint64_t raw_length_ = 0;
  std::vector<Chunk> chunks_;
};

}  // namespace panwright::pan::internal
