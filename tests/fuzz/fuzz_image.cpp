#include <cstdint>

#include "tests/fuzz/targets_gltf.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  panwright::fuzz::image(std::as_bytes(std::span(data, size)));
  return 0;
}
