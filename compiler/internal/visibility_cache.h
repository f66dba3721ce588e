// What a search for visible triangles found, kept between runs. Private to compiler.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/file_cache.h"
#include "base/hash.h"
#include "compiler/internal/visibility.h"

namespace panwright::compiler::internal {

// Grows with every change of what visibility_of() finds. The test VisibilityCache.KnowsItsVersion
// finds out.
inline constexpr std::uint32_t kVisibilityVersion = 1;

// Of all that visibility_of() follows from.
Hash128 visibility_key(const VisibilityModel& model, const VisibilityOptions& options);

// A result as bytes, and back. Nothing: they are of another model.
std::vector<std::byte> visibility_bytes(const Visibility& found);
std::optional<Visibility> visibility_from(std::span<const std::byte> bytes,
                                          const VisibilityModel& model);

// visibility_of(), or the same from a cache: what takes many rays is kept there.
//
//   cache  null: none
//   *known  set: whether the cache had it
// Throws Cancelled.
Visibility cached_visibility_of(const VisibilityModel& model, const VisibilityOptions& options,
                                const FileCache* cache, bool* known, const Job& job);

}  // namespace panwright::compiler::internal
