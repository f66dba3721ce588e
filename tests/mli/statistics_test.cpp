// Statistics of surfaces that are known.
#include <numeric>

#include "tests/mli/sheet_support.h"

namespace panwright::mli::statistics_test {
namespace {

using testing::everything;
using testing::sheet_of;

// Heights of a function of metres.
template <class Function>
Statistics of(std::size_t columns, std::size_t rows, const Vec2& spacing, Function&& height) {
  std::vector<double> heights;
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t i = 0; i < columns; ++i)
      heights.push_back(
          height(spacing.x * static_cast<double>(i), spacing.y * static_cast<double>(j)));
  return measured(heights, columns, spacing);
}

TEST(Statistics, OfAPlane) {
  const Statistics s =
      of(40, 31, {0.01, 0.02}, [](double x, double y) { return 5 + 0.3 * x - 0.4 * y; });
  EXPECT_NEAR(s.slope_mean.x, 0.3, 1e-12);
  EXPECT_NEAR(s.slope_mean.y, -0.4, 1e-12);
  EXPECT_NEAR(s.slope_rms, 0.5, 1e-12);
  EXPECT_NEAR(s.facet_slope_rms, 0.5, 1e-12);
  for (const Covariance& c : {s.slope_covariance, s.facet_slope_covariance}) {
    EXPECT_NEAR(c.xx, 0, 1e-12);
    EXPECT_NEAR(c.xy, 0, 1e-12);
    EXPECT_NEAR(c.yy, 0, 1e-12);
  }
  const Vec3 normal = glm::normalize(Vec3(-0.3, 0.4, 1));
  EXPECT_LT(glm::length(s.mean_normal - normal), 1e-12);
  EXPECT_NEAR(s.height_mean, 5 + 0.3 * 0.195 - 0.4 * 0.3, 1e-12);
  EXPECT_NEAR(s.lowest, 5 - 0.24, 1e-12);
  EXPECT_NEAR(s.highest, 5 + 0.117, 1e-12);
  // 26.565 degrees
  EXPECT_EQ(s.tilt_histogram[53], 2u * 39 * 30);
}

TEST(Statistics, OfALevelSheet) {
  const Statistics s = of(5, 4, {1, 1}, [](double, double) { return 0.1; });
  EXPECT_EQ(s.height_rms, 0);
  EXPECT_EQ(s.height_mean, 0.1);
  EXPECT_EQ(s.slope_rms, 0);
  EXPECT_EQ(s.correlation_length, Vec2(0, 0));
  EXPECT_EQ(s.mean_normal, Vec3(0, 0, 1));
  EXPECT_EQ(s.tilt_histogram[0], 24u);
}

// A wave with crests at an angle: variances, correlation.
TEST(Statistics, OfAWave) {
  const double a = 0.01, kx = 2 * kPi * 20, ky = 2 * kPi * 10;
  const Statistics s = of(2001, 2001, {5e-4, 5e-4},
                          [&](double x, double y) { return a * std::cos(kx * x + ky * y); });
  EXPECT_NEAR(s.height_rms, a / std::sqrt(2.0), 1e-3 * a);
  // central differences lose (k·cell)²/6 of the slope, 7e-4 and 2e-4
  EXPECT_NEAR(s.slope_covariance.xx, a * a * kx * kx / 2, 3e-3 * a * a * kx * kx);
  EXPECT_NEAR(s.slope_covariance.xy, a * a * kx * ky / 2, 3e-3 * a * a * kx * ky);
  EXPECT_NEAR(s.slope_covariance.yy, a * a * ky * ky / 2, 3e-3 * a * a * ky * ky);
  EXPECT_NEAR(s.facet_slope_covariance.xy, a * a * kx * ky / 2, 3e-3 * a * a * kx * ky);
  // cos(k·lag) = 1/e
  EXPECT_NEAR(s.correlation_length.x, std::acos(std::exp(-1.0)) / kx, 2e-2 / kx);
  EXPECT_NEAR(s.correlation_length.y, std::acos(std::exp(-1.0)) / ky, 2e-2 / ky);
  EXPECT_LT(std::hypot(s.mean_normal.x, s.mean_normal.y), 1e-3);
}

// Smoothed noise: the correlation is the kernel's own, once more convolved.
TEST(Statistics, CorrelationOfSmoothedNoise) {
  const Sheet sheet = sheet_of(testing::recipe(600, 600, 600, {Random{1}, Smooth{4}}));
  std::vector<double> kernel{1};
  for (int pass = 0; pass < 8; ++pass) {
    std::vector<double> wider(kernel.size() + 2);
    for (std::size_t k = 0; k < kernel.size(); ++k)
      for (std::size_t n = 0; n < 3; ++n) wider[k + n] += kernel[k] / 3;
    kernel = wider;
  }
  std::size_t lag = 0;
  while (kernel[8 + lag] > kernel[8] / std::exp(1)) ++lag;
  const double before = kernel[8 + lag - 1] / kernel[8], after = kernel[8 + lag] / kernel[8];
  const double exact = static_cast<double>(lag) - 1 + (before - std::exp(-1)) / (before - after);
  EXPECT_NEAR(sheet.statistics.correlation_length.x, exact, 0.05 * exact);
  EXPECT_NEAR(sheet.statistics.correlation_length.y, exact, 0.05 * exact);
}

// The sum of the facets' area vectors depends on the edges alone.
TEST(Statistics, MeanNormalIsThatOfTheEdges) {
  const Sheet sheet = sheet_of(everything());
  EXPECT_EQ(sheet.statistics.mean_normal.z, 1);  // tapered: level all around
  EXPECT_LT(std::hypot(sheet.statistics.mean_normal.x, sheet.statistics.mean_normal.y), 1e-14);
  Recipe open = everything();
  open.operations.resize(9);
  const Sheet free = sheet_of(open);
  double x = 0, y = 0;  // trapezoid rule along the edges
  for (std::uint32_t j = 0; j + 1 < free.rows; ++j)
    x += (free.at(free.columns - 1, j) + free.at(free.columns - 1, j + 1) - free.at(0, j) -
          free.at(0, j + 1)) /
         2;
  for (std::uint32_t i = 0; i + 1 < free.columns; ++i)
    y += (free.at(i, free.rows - 1) + free.at(i + 1, free.rows - 1) - free.at(i, 0) -
          free.at(i + 1, 0)) /
         2;
  const double cells = (free.rows - 1.0) * (free.columns - 1.0);
  const Vec3 exact =
      glm::normalize(Vec3(-x / free.spacing.x / cells, -y / free.spacing.y / cells, 1));
  EXPECT_LT(glm::length(free.statistics.mean_normal - exact), 1e-12);
}

TEST(Statistics, TiltsAreCountedOnce) {
  const Sheet sheet = sheet_of(everything());
  const auto& tilts = sheet.statistics.tilt_histogram;
  EXPECT_EQ(std::accumulate(tilts.begin(), tilts.end(), std::uint64_t{0}),
            2u * (sheet.columns - 1) * (sheet.rows - 1));
  // the mean square of slopes from the histogram's bins
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < tilts.size(); ++k) {
    const double slope = std::tan((static_cast<double>(k) + 0.5) * 0.5 * kDegree);
    sum += static_cast<double>(tilts[k]) * slope * slope;
    count += static_cast<double>(tilts[k]);
  }
  EXPECT_NEAR(std::sqrt(sum / count), sheet.statistics.facet_slope_rms,
              0.002 * sheet.statistics.facet_slope_rms);
}

// Against a measurement of the lower heights.
TEST(Statistics, ScaledIsMeasuredAgain) {
  const auto height = [](double x, double y) {
    return 0.01 + 0.02 * std::sin(40 * x + 5 * y) + 0.01 * std::cos(70 * y) + 0.1 * x;
  };
  const auto lower = [&](double x, double y) { return 0.3 * height(x, y); };
  const Statistics got = scaled(of(90, 70, {0.01, 0.01}, height), 0.3);
  const Statistics want = of(90, 70, {0.01, 0.01}, lower);
  const auto near = [](double a, double b) { EXPECT_NEAR(a, b, 1e-12 * std::fabs(b) + 1e-15); };
  near(got.lowest, want.lowest);
  near(got.highest, want.highest);
  near(got.height_mean, want.height_mean);
  near(got.height_rms, want.height_rms);
  near(got.slope_rms, want.slope_rms);
  near(got.facet_slope_rms, want.facet_slope_rms);
  for (int k = 0; k < 2; ++k) near(got.slope_mean[k], want.slope_mean[k]);
  near(got.slope_covariance.xy, want.slope_covariance.xy);
  near(got.facet_slope_covariance.xx, want.facet_slope_covariance.xx);
  EXPECT_LT(glm::length(got.mean_normal - want.mean_normal), 1e-14);
  EXPECT_EQ(got.correlation_length, want.correlation_length);
  // of tilts the mean, in bins: measured 5e-3
  double means[2] = {0, 0};
  for (std::size_t k = 0; k < Statistics::kBins; ++k) {
    means[0] += static_cast<double>(k) * static_cast<double>(got.tilt_histogram[k]);
    means[1] += static_cast<double>(k) * static_cast<double>(want.tilt_histogram[k]);
  }
  const double facets = 2.0 * 89 * 69;
  EXPECT_NEAR(means[0] / facets, means[1] / facets, 0.02);
}

}  // namespace
}  // namespace panwright::mli::statistics_test
