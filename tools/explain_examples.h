// Examples of diagnostics, and their remedies.
#pragma once

#include <string_view>

#include "base/diagnostic.h"

namespace panwright::tools {

struct CodeExample {
  Code code;
  std::string_view example;  // as typed, or as it occurred
  std::string_view cure;
};

// Returns an example; nullptr: a code without one, which a test forbids.
const CodeExample* example_of(Code code);

}  // namespace panwright::tools
