#include <cstdint>

#include "tests/fuzz/targets_roundtrip.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  panwright::fuzz::roundtrip(std::as_bytes(std::span(data, size)));
  return 0;
}
