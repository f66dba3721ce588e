// Pan files with one defect each.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostic.h"

namespace panwright::support {

struct DamagedPan {
  Code code;         // expected of a reader
  std::string what;  // the defect
  std::vector<std::byte> bytes;
};

// Returns files of valid checksums with every kind of invalid contents, and files damaged in
// transit. Each error code of pan files occurs.
std::vector<DamagedPan> damaged_pans();

// Returns one file for each error code of pan files.
std::vector<std::pair<Code, std::vector<std::byte>>> damaged_examples();

}  // namespace panwright::support
