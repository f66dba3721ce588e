// Contents held in a model's own memory: decompressed, or in records of another size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "pan/internal/packing.h"
#include "pan/model.h"

namespace panwright::pan::internal {

// Write access to a Model while it is checked.
struct Unpacked {
  // Allocates memory for a section's contents, which the model hands out from now on; the same
  // memory each time. No bytes: out of memory.
  //
  // Expects: bytes > 0.
  static std::span<std::byte> make(Model& model, layout::SectionKind kind, std::uint64_t bytes);
  static void drop(Model& model, layout::SectionKind kind);
};

// The chunks of a section of the model's file. Nothing: their lengths do not add up.
std::optional<PackedChunks> chunks_of(const Model& model, const layout::DirectoryEntry& entry);

// Copies records of one size to another: drops the tail of longer ones, fills missing fields with 0
// or their default. A field held in part is missing.
//
//   from, to   whole records, equally many
//   defaults   those of the section's fields, by offset
void resize_records(std::span<const std::byte> from, std::uint32_t from_stride,
                    std::span<std::byte> to, std::uint32_t to_stride,
                    std::span<const layout::FieldDefault> defaults);

}  // namespace panwright::pan::internal
