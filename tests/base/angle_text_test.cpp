#include "base/angle_text.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "base/math.h"

namespace panwright::angle_text_test {
namespace {

TEST(AngleText, FindsRoundAnglesInRadians) {
  const std::pair<const char*, const char*> radians[] = {{"1.5708", "90"},
                                                         {"1.57", "90"},
                                                         {"-1.5708", "-90"},
                                                         {"3.14", "180"},
                                                         {"3.14159", "180"},
                                                         {"6.2832", "360"},
                                                         {"0.785", "45"},
                                                         {"0.7854", "45"},
                                                         {"1.0472", "60"},
                                                         {"0.1745", "10"},
                                                         {"1.5707963267948966", "90"}};
  for (const auto& [number, degrees] : radians) EXPECT_EQ(degrees_of_radians(number), degrees);
  for (const char* number : {"1.5", "90", "1.6", "0.78", "30.0", "1.58", "0.175", "1.5710", "0",
                             "0.00", "7.854", "1.5708deg", "", "x", "1.57e0", "."})
    EXPECT_FALSE(degrees_of_radians(number)) << number;
}

// Every multiple of 5 degrees, printed by another program's rules; those between are not found.
TEST(AngleText, KnowsEveryFiveDegrees) {
  for (int degrees = 5; degrees <= 360; degrees += 5) {
    EXPECT_EQ(degrees_of_radians(fmt::format("{:.6f}", degrees * kDegree)),
              std::to_string(degrees));
    EXPECT_FALSE(degrees_of_radians(fmt::format("{:.6f}", (degrees - 2.5) * kDegree)));
  }
}

}  // namespace
}  // namespace panwright::angle_text_test
