// Measurements of a run.
#include "studio/measure.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace panwright::studio {
namespace {

TEST(Series, KeepsFewOfMany) {
  Series series(64);
  for (int i = 0; i < 10000; ++i) series.add(i == 7777 ? 5e4 : i);
  EXPECT_EQ(series.count(), 10000u);
  EXPECT_LT(series.kept().size(), 64u);
  EXPECT_GE(series.kept().size(), 32u);
  for (std::size_t k = 0; k < series.kept().size(); ++k)
    EXPECT_EQ(series.kept()[k], static_cast<double>(k * series.every()));
  EXPECT_EQ(series.largest(), 5e4);
  EXPECT_EQ(series.quantile(1), 5e4);
  EXPECT_NEAR(series.quantile(0.5), 5000, 200);
}

TEST(Series, Quantiles) {
  Series series(64);
  EXPECT_EQ(series.quantile(0.5), 0);
  for (const double value : {-3.0, -1.0, -2.0, -4.0}) series.add(value);
  EXPECT_EQ(series.quantile(0), -4);
  EXPECT_EQ(series.quantile(0.5), -3);
  EXPECT_EQ(series.quantile(0.75), -2);
  EXPECT_EQ(series.largest(), -1);
}

TEST(ResidentBytes, GrowWithMemoryInUse) {
  const std::uint64_t before = resident_bytes();
  if (before == 0) GTEST_SKIP() << "not available";
  std::vector<char> more(256 << 20);
  std::memset(more.data(), 1, more.size());
  EXPECT_GT(resident_bytes(), before + (128 << 20));
  EXPECT_EQ(more[12345], 1);
}

}  // namespace
}  // namespace panwright::studio
