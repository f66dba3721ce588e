#include "base/random.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

namespace panwright::random_test {
namespace {

using Words = std::array<std::uint32_t, 4>;

// the known answers of the Random123 library
TEST(Random, PhiloxKnownAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  const std::uint32_t ones = 0xffffffff;
  EXPECT_EQ(philox({ones, ones, ones, ones}, {ones, ones}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, UnitIntervalHasNoEnds) {
  EXPECT_EQ(in_unit(0), 0x1p-33);
  EXPECT_EQ(in_unit(0xffffffff), 1 - 0x1p-33);
}

// Neighbouring counters, as pixels use them: every bit is 0 or 1 as often as coins are.
TEST(Random, NeighboursAreIndependent) {
  constexpr std::uint32_t kCount = 20000;
  std::array<std::array<int, 32>, 4> set{};
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const Words here = philox({i, 0, 0, 0}, {1, 0});
    const Words next = philox({i + 1, 0, 0, 0}, {1, 0});
    for (std::size_t k = 0; k < 4; ++k)
      for (std::uint32_t bit = 0; bit < 32; ++bit) set[k][bit] += (here[k] ^ next[k]) >> bit & 1;
  }
  for (const auto& word : set)
    for (const int count : word)  // 5 sigma of coins thrown 20,000 times: 1 in 14,000 for all 128
      EXPECT_NEAR(count, kCount / 2.0, 5 * std::sqrt(kCount / 4.0));
}

}  // namespace
}  // namespace panwright::random_test
