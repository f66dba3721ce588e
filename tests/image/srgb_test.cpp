#include "image/srgb.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace panwright::image::srgb_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Oracle: the sRGB formula forwards, in long double, where the table inverts it.
TEST(Srgb, CodesAreTheNearestOnes) {
  const auto encoded = [](long double x) {
    return x <= 0.0031308L ? 12.92L * x : 1.055L * std::pow(x, 1 / 2.4L) - 0.055L;
  };
  int previous = 0;
  for (int i = 0; i <= 200000; ++i) {
    const double linear = i / 200000.0;
    const int code = srgb_code(linear);
    EXPECT_GE(code, previous);
    previous = code;
    // the two branches of the standard meet with a step of 3e-8, hence the tolerance
    EXPECT_LE(std::fabs(255 * static_cast<double>(encoded(linear)) - code), 0.5 + 1e-5) << linear;
  }
  EXPECT_EQ(previous, 255);
}

TEST(Srgb, EndsAndRoundTrip) {
  EXPECT_EQ(srgb_code(-1), 0);
  EXPECT_EQ(srgb_code(0), 0);
  EXPECT_EQ(srgb_code(1), 255);
  EXPECT_EQ(srgb_code(kInfinity), 255);
  EXPECT_EQ(srgb_code(-kInfinity), 0);
  EXPECT_EQ(srgb_code(std::nan("")), 0);
  for (int code = 0; code < 256; ++code)
    EXPECT_EQ(srgb_code(srgb_decoded(static_cast<std::uint8_t>(code))), code);
  EXPECT_EQ(srgb_decoded(0), 0);
  EXPECT_EQ(srgb_decoded(255), 1);
  // IEC 61966-2-1 linear part: 10/255/12.92
  EXPECT_DOUBLE_EQ(srgb_decoded(10), 10 / 255.0 / 12.92);
}

}  // namespace
}  // namespace panwright::image::srgb_test
