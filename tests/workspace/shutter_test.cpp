#include "workspace/shutter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

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

// A pulse lights a row as long as their times have in common; the rest is as without.
TEST(ShutterMoments, CutWhereTheLightChanges) {
  std::vector<Case> cases(std::begin(kCases), std::end(kCases));
  for (const Shutter& still : {Shutter{0.3, 0.01, 64}, Shutter{0, -0.02, 40}})
    cases.push_back({still, 0, 0.5});
  for (const Case& each : cases) {
    if (each.shutter.line_time == 0) continue;
    const double low = 0.13 * each.shutter.end(), high = 0.31 * each.shutter.end();
    const double cuts[] = {low, high, -1e3, 1e3};
    const ShutterMoments whole(each.shutter, each.speed, each.step);
    const ShutterMoments moments(each.shutter, each.speed, each.step, cuts);
    for (std::uint32_t row = 0; row < each.shutter.rows; ++row) {
      const double line = each.shutter.line_time;
      const double delay = line < 0 ? -line * (each.shutter.rows - 1 - row) : line * row;
      double sum = 0, lit = 0, blurred = 0;
      for (std::size_t k = 0; k < moments.count(); ++k) {
        EXPECT_LT(moments.begin(k), moments.end(k));
        EXPECT_EQ(moments.time(k) > low && moments.time(k) < high,
                  moments.begin(k) >= low && moments.end(k) <= high);
        sum += moments.share(k, row);
        if (moments.time(k) > low && moments.time(k) < high) lit += moments.share(k, row);
        const ShutterMoments::Rows rows = moments.rows(k);
        if (moments.share(k, row) > 0 || moments.middle(row) == k)
          EXPECT_TRUE(row >= rows.first && row < rows.end);
      }
      // exposures that are too short to matter are longer in moments
      for (std::size_t k = 0; k < whole.count(); ++k)
        if (whole.share(k, row) > 0) blurred += whole.end(k) - whole.begin(k);
      const double exposure =
          each.speed > 0 ? std::max(each.shutter.exposure, blurred) : each.shutter.exposure;
      EXPECT_NEAR(sum, 1, 1e-7);
      if (each.shutter.exposure < 0.05 && each.speed > 0) {
        if (delay + exposure < low || delay - exposure > high) EXPECT_EQ(lit, 0);
        if (delay - exposure > low && delay + exposure < high) EXPECT_NEAR(lit, 1, 1e-7);
      } else if (each.shutter.exposure == 0) {
        EXPECT_EQ(lit, delay >= low && delay < high ? 1 : 0) << row;
      } else {
        const double half = 0.5 * each.shutter.exposure;
        const double common = std::min(delay + half, high) - std::max(delay - half, low);
        EXPECT_NEAR(lit, std::max(common, 0.0) / each.shutter.exposure, 1e-6) << row;
      }
      EXPECT_LE(moments.begin(moments.middle(row)), delay + 1e-12);
      EXPECT_GE(moments.end(moments.middle(row)), delay - 1e-12);
    }
  }
}

}  // namespace
}  // namespace panwright::workspace::shutter_test
