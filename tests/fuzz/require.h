// Assertion of fuzz targets.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

namespace panwright::fuzz {

// Aborts if the condition is false; fuzzers and tests detect it.
inline void require(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what.c_str());
  std::abort();
}

}  // namespace panwright::fuzz
