#include <cstdint>

#include "tests/fuzz/targets_scenario.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  panwright::fuzz::scenario(std::as_bytes(std::span(data, size)));
  return 0;
}
