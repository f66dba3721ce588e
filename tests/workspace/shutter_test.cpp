#include "workspace/shutter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace panwright::workspace::shutter_test {
namespace {

struct Case {
  Shutter shutter;
  double speed, step;
};

constexpr Case kCases[] = {{{0.5, 0, 40}, 16, 0.5},     {{0.1, 0, 1}, 30, 0.5},
                           {{0, 0.02, 40}, 16, 0.5},    {{0, -0.02, 40}, 16, 0.5},
                           {{0.3, 0.01, 64}, 20, 0.5},  {{0.37, -0.013, 57}, 7.3, 1},
                           {{1e-6, 0.001, 100}, 50, 1}, {{0.2, 1e-7, 1024}, 30, 0.5}};

// A row takes time from its own exposure alone, and its mean time is the middle of it.
TEST(ShutterMoments, SharesOfARowAreItsExposure) {
  for (const Case& each : kCases) {
    const ShutterMoments moments(each.shutter, each.speed, each.step);
    ASSERT_GT(moments.count(), 1u);
    EXPECT_LE(moments.step(), each.step * (1 + 1e-12));
    for (std::uint32_t row = 0; row < each.shutter.rows; ++row) {
      const double line = each.shutter.line_time;
      const double delay = line < 0 ? -line * (each.shutter.rows - 1 - row) : line * row;
      double sum = 0, mean = 0;
      for (std::size_t k = 0; k < moments.count(); ++k) {
        const double share = moments.share(k, row);
        sum += share;
        mean += share * moments.time(k);
        const ShutterMoments::Rows rows = moments.rows(k);
        if (share > 0 || moments.middle(row) == k) {
          EXPECT_TRUE(row >= rows.first && row < rows.end);
        }
      }
      EXPECT_NEAR(sum, 1, 1e-7);
      EXPECT_NEAR(mean * each.speed, delay * each.speed, 1e-6) << row;
    }
    const double half = 0.5 * (moments.time(1) - moments.time(0));
    EXPECT_LE(moments.time(moments.count() - 1), each.shutter.end() + half * (1 + 1e-9));
    EXPECT_GE(moments.time(0), each.shutter.begin());
  }
}

TEST(ShutterMoments, OneMomentOfAnImageAtOnceIsTheTimeOfTheFrame) {
  for (const double exposure : {0.1, 0.4, 1.3, 500.0}) {
    const ShutterMoments moments({exposure, 0, 8}, 10, 0.5);
    EXPECT_EQ(moments.count() % 2, 1u);
    EXPECT_NEAR(moments.time(moments.middle(5)), 0, 1e-12);
  }
}

TEST(ShutterMoments, AreOneWhereNothingMovesAndLimited) {
  EXPECT_EQ(ShutterMoments({1, 0.1, 100}, 0, 0.5).count(), 1u);
  EXPECT_EQ(ShutterMoments({1, 0, 100}, 0.4, 0.5).count(), 1u);
  EXPECT_EQ(ShutterMoments({1, 0, 100}, 0.6, 0.5).count(), 3u);
  for (const Shutter& shutter : {Shutter{1, 0, 100}, Shutter{0, 1, 100}, Shutter{1e-3, 1, 4000}}) {
    const ShutterMoments many(shutter, 1e6, 0.5);
    EXPECT_LE(many.count(), ShutterMoments::kMost);
    EXPECT_GE(many.count(), ShutterMoments::kMost / 2);
    EXPECT_GT(many.step(), 0.5);
  }
}

}  // namespace
}  // namespace panwright::workspace::shutter_test
