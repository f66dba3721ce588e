// Files packed by gzip, told by their first bytes.
#pragma once

#include <cstdint>
#include <string>

#include "base/source.h"

namespace panwright::importers::internal {

struct Unpacked {
  SharedText bytes;     // what could be unpacked; null: nothing
  std::string problem;  // empty: all went well
};

// The contents of a gzip file, all its members, checksums and lengths verified; of one that is
// packed again, up to three times, the innermost; other bytes as they are. A file cut short gives
// what could be read, and a problem that names the byte.
Unpacked unpacked(SharedText bytes, std::uint64_t max_bytes);

}  // namespace panwright::importers::internal
