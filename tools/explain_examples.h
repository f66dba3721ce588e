// What brings a diagnostic about, and what helps.
#pragma once

#include <string_view>

#include "base/diagnostic.h"

namespace panwright::tools {

struct CodeExample {
  Code code;
  std::string_view example;  // as typed, or as it came about
  std::string_view cure;
};

// nullptr: a code that has none, which a test forbids.
const CodeExample* example_of(Code code);

}  // namespace panwright::tools
