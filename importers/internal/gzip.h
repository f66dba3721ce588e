// Unpacking of gzip files, recognised by their first bytes.
#pragma once

#include <cstdint>
#include <string>

#include "base/source.h"

namespace panwright::importers::internal {

struct Unpacked {
  SharedText bytes;     // the unpacked part; null: nothing
  std::string problem;  // empty: success
};

// Unpacks all members of a gzip file, checksums and lengths verified, nested up to three times;
// returns other bytes unchanged. A truncated file gives its readable part, and a problem that names
// the byte.
Unpacked unpacked(SharedText bytes, std::uint64_t max_bytes);

}  // namespace panwright::importers::internal
