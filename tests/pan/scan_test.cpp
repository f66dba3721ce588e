// The loops over four lanes against one element at a time.
#include "pan/internal/scan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace panwright::pan::internal::scan_test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Good values with one other at each place, for lengths around the number of lanes.
template <class T, class Test>
void at_each_place(const std::vector<T>& good, const std::vector<T>& bad, Test test) {
  for (std::size_t n = 0; n <= good.size(); ++n) {
    // exact size, so that a sanitizer sees a read behind the end
    std::vector<T> values(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(n));
    values.shrink_to_fit();
    EXPECT_TRUE(test(values)) << n;
    for (std::size_t i = 0; i < n; ++i) {
      for (const T other : bad) {
        const T before = std::exchange(values[i], other);
        EXPECT_FALSE(test(values)) << n << ' ' << i << ' ' << +other;
        values[i] = before;
      }
    }
  }
}

TEST(Scan, IndicesBelowALimit) {
  at_each_place<std::uint16_t>(std::vector<std::uint16_t>(21, 0x8000), {0x8001, 0xffff},
                               [](const auto& v) { return all_below(v.data(), v.size(), 0x8001); });
  at_each_place<std::uint32_t>(
      std::vector<std::uint32_t>(21, 0x7fffffffu), {0x80000000u, 0xffffffffu},
      [](const auto& v) { return all_below(v.data(), v.size(), 0x80000000u); });
  const std::uint16_t largest = 0xffff;
  EXPECT_FALSE(all_below(&largest, 1, 0xffff));
  EXPECT_TRUE(all_below(&largest, 1, 0x10000));
  EXPECT_TRUE(all_below(&largest, 1, 0x10001));
}

TEST(Scan, NumbersBetweenLimits) {
  constexpr float kMost = std::numeric_limits<float>::max();
  const std::vector<float> good(11, kMost);
  at_each_place<float>(good, {kNan, kInfinity, -kInfinity}, [](const auto& v) {
    return all_between(v.data(), v.size(), -kMost, kMost);
  });
  at_each_place<float>(std::vector<float>(11, 2),
                       {kNan, kInfinity, -kInfinity, -1e-45f, 2.0000002f},
                       [](const auto& v) { return all_between(v.data(), v.size(), 0, 2); });
  const float minus_zero = -0.0f;
  EXPECT_TRUE(all_between(&minus_zero, 1, 0, 2));
}

TEST(Scan, VectorsInABox) {
  const float low[] = {-1, 10, 0}, high[] = {1, 20, 0};
  std::vector<float> good;
  for (int i = 0; i < 11; ++i) good.insert(good.end(), {i % 2 ? -1.0f : 1.0f, 10 + 1.0f * i, 0});
  for (std::size_t n = 0; n <= 11; ++n) {
    std::vector<float> values(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(3 * n));
    EXPECT_TRUE(all_within(values.data(), n, low, high));
    for (std::size_t i = 0; i < 3 * n; ++i) {
      const float below = std::nextafter(low[i % 3], -kInfinity);
      const float above = std::nextafter(high[i % 3], kInfinity);
      for (const float other : {below, above, kNan, kInfinity, -kInfinity}) {
        const float before = std::exchange(values[i], other);
        EXPECT_FALSE(all_within(values.data(), n, low, high)) << n << ' ' << i << ' ' << other;
        values[i] = before;
      }
    }
  }
}

TEST(Scan, UnitVectorsByADoubleReference) {
  std::mt19937 random(7);
  const auto uniform = [&] { return static_cast<double>(random()) / 2147483648.0 - 1.0; };
  double largest_residual = 0;
  for (int turn = 0; turn < 20000; ++turn) {
    double v[3] = {uniform(), uniform(), uniform()};
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    // every fourth is scaled by up to 1e-4, and the place among four lanes changes
    const double scale = turn % 4 == 0 ? 1 + 1e-4 * uniform() : 1;
    float lanes[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1};
    const int place = turn / 4 % 4;
    double squared = 0;
    for (int k = 0; k < 3; ++k) {
      lanes[3 * place + k] = static_cast<float>(scale * v[k] / length);
      squared += static_cast<double>(lanes[3 * place + k]) * lanes[3 * place + k];
    }
    const double off = std::fabs(squared - 1);
    if (scale == 1) largest_residual = std::max(largest_residual, off);
    // the sum in float is within 2.4e-7 of that in double: within this band either may be said
    if (std::fabs(off - kUnitTolerance) < 4e-7) continue;
    EXPECT_EQ(all_unit(lanes, 4), off < kUnitTolerance) << off;
    EXPECT_EQ(all_unit(lanes + 3 * place, 1), off < kUnitTolerance) << off;
  }
  // correctly rounded unit vectors: 1.05e-7 seen, 2·2^-24 the bound
  EXPECT_LE(largest_residual, 1.2e-7);
  EXPECT_GT(largest_residual, 5e-8);
}

// The definition itself: decode to a code point, then look at its value and its shortest form.
bool is_text_by_definition(const std::string& text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    std::size_t length = 1;
    std::uint32_t point = byte(i);
    if (byte(i) >= 0x80) {
      length = (byte(i) & 0xe0) == 0xc0 ? 2 : (byte(i) & 0xf0) == 0xe0 ? 3 : 4;
      if (length == 4 && (byte(i) & 0xf8) != 0xf0) return false;
      if (i + length > text.size()) return false;
      point = byte(i) & (0xffu >> (length + 1));
      for (std::size_t k = 1; k < length; ++k) {
        if ((byte(i + k) & 0xc0) != 0x80) return false;
        point = point << 6 | (byte(i + k) & 0x3f);
      }
    }
    const std::size_t shortest = point < 0x80 ? 1 : point < 0x800 ? 2 : point < 0x10000 ? 3 : 4;
    if (point == 0 || point > 0x10ffff || (point >= 0xd800 && point < 0xe000)) return false;
    if (length != shortest) return false;
    i += length;
  }
  return true;
}

TEST(Scan, TextIsUtf8) {
  // every string of up to three bytes, of the bytes at which some rule changes
  const std::vector<int> edges = {0x00, 0x01, 0x41, 0x7f, 0x80, 0x8f, 0x90, 0x9f, 0xa0, 0xbf,
                                  0xc0, 0xc1, 0xc2, 0xdf, 0xe0, 0xe1, 0xec, 0xed, 0xee, 0xef,
                                  0xf0, 0xf1, 0xf3, 0xf4, 0xf5, 0xf7, 0xf8, 0xff};
  std::size_t good = 0;
  const auto same = [&](const std::string& text) {
    const bool expected = is_text_by_definition(text);
    good += expected;
    ASSERT_EQ(is_text(text), expected) << testing::PrintToString(text);
  };
  same("");
  for (const int a : edges) {
    same({static_cast<char>(a)});
    for (const int b : edges) {
      same({static_cast<char>(a), static_cast<char>(b)});
      for (const int c : edges) {
        same({static_cast<char>(a), static_cast<char>(b), static_cast<char>(c)});
        for (const int d : edges)
          same({static_cast<char>(a), static_cast<char>(b), static_cast<char>(c),
                static_cast<char>(d)});
      }
    }
  }
  EXPECT_GT(good, 500u);
}

}  // namespace
}  // namespace panwright::pan::internal::scan_test
