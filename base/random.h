// Counter-based random numbers: functions of a counter and a key.
#pragma once

#include <array>
#include <cstdint>

namespace panwright {

// Four words for a counter and a key: Philox4x32-10. The same on every machine; any two counters
// give independent words, so no state is passed on and the order of use does not matter.
//
// J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, "Parallel random numbers: as easy as 1, 2,
// 3", 2011.
constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                              std::array<std::uint32_t, 2> key) {
  // multipliers and Weyl steps of the paper, table 2
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53u} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57u} * counter[2];
    counter = {
        static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
        static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

// Converts a word to a number in (0, 1): the middle of its 2^-32 wide step.
constexpr double in_unit(std::uint32_t word) { return (word + 0.5) * 0x1p-32; }

}  // namespace panwright
