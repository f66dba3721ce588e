// Pan files with one thing wrong each.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostic.h"

namespace panwright::support {

struct DamagedPan {
  Code code;         // what a reader must say
  std::string what;  // what is wrong
  std::vector<std::byte> bytes;
};

// Files whose checksums are right around every kind of nonsense, and files damaged on their way.
// Each error code of pan files occurs.
std::vector<DamagedPan> damaged_pans();

// One file for each error code of pan files.
std::vector<std::pair<Code, std::vector<std::byte>>> damaged_examples();

}  // namespace panwright::support
