// What a target must find to hold.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

namespace panwright::fuzz {

// Aborts, which fuzzers and tests notice, where something does not hold.
inline void require(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what.c_str());
  std::abort();
}

}  // namespace panwright::fuzz
