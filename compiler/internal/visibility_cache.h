// Cache of searches for visible triangles between runs. Private to compiler.
#pragma once

#include "base/work_cache.h"
#include "compiler/internal/visibility.h"

namespace panwright::compiler::internal {

// Returns the hash of all inputs of visibility_of().
Hash128 visibility_key(const VisibilityModel& model, const VisibilityOptions& options);

// Serialisation to bytes and back. The reader fails on bytes of another model.
void write_visibility(const Visibility& found, ByteWriter& to);
Visibility read_visibility(const VisibilityModel& model, ByteReader& from);

// Calls visibility_of(), or returns the same from a cache, which keeps results of many rays.
//
//   cache  null: none
//   *known  set to true on a cache hit
// Throws Cancelled.
Visibility cached_visibility_of(const VisibilityModel& model, const VisibilityOptions& options,
                                const WorkCache* cache, bool* known, const Job& job);

}  // namespace panwright::compiler::internal
