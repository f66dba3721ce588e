// Cache of searches for visible triangles between runs. Private to compiler.
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

// Version of the results of visibility_of(), checked by the test VisibilityCache.KnowsItsVersion.
inline constexpr std::uint32_t kVisibilityVersion = 1;

// Returns the hash of all inputs of visibility_of().
Hash128 visibility_key(const VisibilityModel& model, const VisibilityOptions& options);

// Converts a result to bytes, and back. Nothing: they are of another model.
std::vector<std::byte> visibility_bytes(const Visibility& found);
std::optional<Visibility> visibility_from(std::span<const std::byte> bytes,
                                          const VisibilityModel& model);

// Calls visibility_of(), or returns the same from a cache, which keeps results of many rays.
//
//   cache  null: none
//   *known  set to true on a cache hit
// Throws Cancelled.
Visibility cached_visibility_of(const VisibilityModel& model, const VisibilityOptions& options,
                                const FileCache* cache, bool* known, const Job& job);

}  // namespace panwright::compiler::internal
