#include <cstdint>

#include "tests/fuzz/targets_terrain.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)panwright::fuzz::terrain(std::as_bytes(std::span(data, size)));
  return 0;
}
