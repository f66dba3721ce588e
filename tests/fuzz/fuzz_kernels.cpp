#include <cstdint>
#include <string>

#include "tests/ephemeris/support.h"
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string broken;
  panwright::ephemeris::testing_support::ask_all(
      std::string(reinterpret_cast<const char*>(data), size), broken);
  panwright::fuzz::require(broken.empty(), broken);
  return 0;
}
