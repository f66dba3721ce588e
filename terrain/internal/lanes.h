// Four floats at once, a lane each. Private to terrain.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

namespace panwright::terrain::internal {

typedef float F4 __attribute__((vector_size(16)));
typedef std::int32_t I4 __attribute__((vector_size(16)));

inline F4 lanes(const std::array<float, 4>& from) {
  F4 out;
  std::memcpy(&out, from.data(), sizeof out);
  return out;
}

}  // namespace panwright::terrain::internal
