// Moments of slopes that coarse triangles leave out, against sums over the source's posts.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "terrain/ground.h"
#include "terrain/tile_writer.h"
#include "tests/support/process.h"
#include "tests/terrain/made_files.h"

namespace panwright::terrain::slopes_test {
namespace {

using testing_support::bytes_of;
using testing_support::Kind;
using testing_support::label_of;

struct Made {
  std::uint32_t width, height;
  std::vector<float> z;
  std::optional<Ground> ground;

  double at(std::int64_t x, std::int64_t y) const {
    x = std::clamp<std::int64_t>(x, 0, width - 1);
    y = std::clamp<std::int64_t>(y, 0, height - 1);
    return double(z[static_cast<std::size_t>(y * width + x)]);
  }
};

using Heights = std::function<double(std::uint32_t, std::uint32_t)>;

Made made(Kind kind, std::uint32_t width, std::uint32_t height, const Heights& heights) {
  Made out{width, height, {}, {}};
  std::string data;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      out.z.push_back(static_cast<float>(heights(x, y)));
      data += bytes_of(out.z.back(), false);
    }
  if (auto tiles = tiles_of(kind, data, label_of(kind, width, height)))
    out.ground.emplace(std::move(tiles));
  return out;
}

// Slopes of a post, per 10 m.
Vec2 slope_at(const Made& made, std::int64_t x, std::int64_t y) {
  const auto apart = [](std::int64_t at, std::uint32_t posts) {
    return at > 0 && at + 1 < posts ? 20.0 : 10.0;
  };
  return {(made.at(x + 1, y) - made.at(x - 1, y)) / apart(x, made.width),
          (made.at(x, y + 1) - made.at(x, y - 1)) / apart(y, made.height)};
}

// Means over the cells of a square, at two Gaussian places a side: exact for what is linear between
// posts, and for its products.
GroundRelief sums(const Made& made, std::uint32_t x0, std::uint32_t y0, std::uint32_t side) {
  GroundRelief out;
  double count = 0;
  for (std::uint32_t y = y0; y < std::min(y0 + side, made.height - 1); ++y)
    for (std::uint32_t x = x0; x < std::min(x0 + side, made.width - 1); ++x)
      for (const double v : {0.5 - std::sqrt(1 / 12.0), 0.5 + std::sqrt(1 / 12.0)})
        for (const double u : {0.5 - std::sqrt(1 / 12.0), 0.5 + std::sqrt(1 / 12.0)}) {
          const Vec2 s =
              (1 - v) * ((1 - u) * slope_at(made, x, y) + u * slope_at(made, x + 1, y)) +
              v * ((1 - u) * slope_at(made, x, y + 1) + u * slope_at(made, x + 1, y + 1));
          out.p += s.x;
          out.q += s.y;
          out.pp += s.x * s.x;
          out.qq += s.y * s.y;
          out.pq += s.x * s.y;
          ++count;
        }
  for (double* each : {&out.p, &out.q, &out.pp, &out.qq, &out.pq}) *each /= count;
  out.pp -= out.p * out.p;
  out.qq -= out.q * out.q;
  out.pq -= out.p * out.q;
  return out;
}

double rough(std::uint32_t x, std::uint32_t y) {
  const std::uint32_t noise = ((x * 73856093u) ^ (y * 19349663u)) * 2654435761u;
  return 60 * std::sin(x * 0.11) * std::cos(y * 0.07) + 4 * double(noise >> 8) / (1 << 24);
}

TEST(Slopes, BlocksOfAllLevels) {
  const Made field = made(Kind::plane, 2300, 301, rough);
  double fine = 0, stored = 0;
  for (std::uint32_t level = 1; level <= 4; ++level)
    for (std::uint32_t k = 0; k < 40; ++k) {
      GroundPoint point;
      point.level = level;
      point.column = (k * 7919) % ((2299 >> level) + 1);
      point.row = (k * 104729) % ((300 >> level) + 1);
      point.position = {0, 0, 1};
      const GroundRelief found = field.ground->relief(point);
      ASSERT_TRUE(found);
      EXPECT_EQ(found.right, Vec3(1, 0, 0));
      EXPECT_EQ(found.down, Vec3(0, -1, 0));
      const std::uint32_t side = 2u << level;
      const GroundRelief want = sums(field, point.column / 2 * side, point.row / 2 * side, side);
      const double off = std::max({std::fabs(found.p - want.p), std::fabs(found.q - want.q),
                                   std::fabs(std::sqrt(found.pp) - std::sqrt(want.pp)),
                                   std::fabs(std::sqrt(found.qq) - std::sqrt(want.qq))});
      // at the border of a tile slopes are of posts on one side
      double& worst = level < 3 ? fine : stored;
      worst = std::max(worst, off);
      EXPECT_NEAR(found.pq, want.pq, level < 3 ? 1e-6 : 0.02 * std::sqrt(want.pp * want.qq)) << k;
    }
  printf("slopes: %.1e off, of stored blocks %.1e\n", fine, stored);
  EXPECT_LT(fine, 1e-5);    // measured: 5.8e-7
  EXPECT_LT(stored, 0.02);  // 3.8e-3, at the borders of tiles
}

// Of large charts: moments of level 2 by its own posts and a block of four such squares, whose
// moments they have together.
TEST(Slopes, DividedBlocks) {
  const Made field = made(Kind::plane, 2300, 301, rough);
  const Ground large(std::make_shared<const Tiles>(field.ground->tiles()), Ground::kTreeBytes, 0);
  double together = 0, each = 0;
  for (std::uint32_t k = 0; k < 40; ++k) {
    const std::uint32_t x = (k * 7919) % 140, y = (k * 104729) % 18;
    GroundPoint point;
    point.position = {0, 0, 1};
    point.level = 3;
    point.column = 2 * x;
    point.row = 2 * y;
    const GroundRelief block = large.relief(point);
    ASSERT_TRUE(block);
    point.level = 2;
    Vec4 mean(0);
    for (std::uint32_t c = 0; c < 4; ++c) {
      point.column = 4 * x + 2 * (c % 2) + k % 2;
      point.row = 4 * y + 2 * (c / 2);
      const GroundRelief found = large.relief(point);
      ASSERT_TRUE(found);
      mean +=
          0.25 * Vec4(found.p, found.q, found.pp + found.p * found.p, found.qq + found.q * found.q);
      const GroundRelief want = sums(field, 4 * point.column - 4 * (k % 2), 4 * point.row, 8);
      each = std::max({each, std::fabs(found.p - want.p), std::fabs(found.q - want.q)});
    }
    const Vec4 want(block.p, block.q, block.pp + block.p * block.p, block.qq + block.q * block.q);
    const Vec4 off = glm::abs(mean - want);
    together = std::max({together, off.x, off.y, off.z, off.w});
  }
  printf("divided blocks: %.1e off together, %.1e each\n", together, each);
  EXPECT_LT(together, 1e-12);  // measured: 1.1e-16
  // of slopes of 0.7 and steps of 4 m at random between posts 10 m apart: measured 0.029
  EXPECT_LT(each, 0.05);
  EXPECT_GT(each, 1e-4);
}

// The heights rise along an axis of the body, and so do slopes, in the axes that they are told in.
void expect_axes(Kind kind) {
  const Vec3 rise(0.004, -0.01, 0.007);
  const Made field = made(kind, 1200, 600, [&](std::uint32_t x, std::uint32_t y) {
    return glm::dot(rise, testing_support::place_of(kind, x, y, 0, 1200, 600));
  });
  double worst = 0;
  for (const std::uint32_t level : {1u, 2u, 3u})
    for (std::uint32_t k = 0; k < 30; ++k) {
      GroundPoint point;
      point.level = level;
      point.column = (k * 7919) % (1199 >> level);
      point.row = (k * 104729) % (599 >> level);
      point.position =
          testing_support::place_of(kind, point.column << level, point.row << level, 0, 1200, 600);
      const GroundRelief found = field.ground->relief(point);
      ASSERT_TRUE(found);
      EXPECT_NEAR(glm::dot(found.up, glm::normalize(point.position)), 1, 1e-12);
      worst = std::max({worst, std::fabs(found.p - glm::dot(rise, found.right)),
                        std::fabs(found.q - glm::dot(rise, found.down))});
    }
  printf("slopes along an axis of the body: %.1e off\n", worst);
  EXPECT_LT(worst, 1e-3);  // measured: 1.8e-4
}
TEST(Slopes, AxesOfACylindricalMap) { expect_axes(Kind::cylindrical); }
TEST(Slopes, AxesOfAPolarMap) { expect_axes(Kind::polar); }

TEST(Slopes, NoneOfVoidsAndOfTheFinest) {
  const Made field = made(Kind::plane, 1200, 300, [](std::uint32_t x, std::uint32_t) {
    return x < 600 ? std::nan("") : 0.5 * x;
  });
  GroundPoint point;
  point.position = {0, 0, 1};
  for (const std::uint32_t level : {1u, 2u, 3u}) {
    point.level = level;
    point.row = 2;
    point.column = 500 >> level;
    EXPECT_FALSE(field.ground->relief(point)) << level;
    point.column = 800 >> level;
    const GroundRelief found = field.ground->relief(point);
    ASSERT_TRUE(found) << level;
    EXPECT_NEAR(found.p, 0.05, 1e-6) << level;
    EXPECT_NEAR(found.pp, 0, 1e-9) << level;
  }
  point.level = 0;
  EXPECT_FALSE(field.ground->relief(point));
}

}  // namespace
}  // namespace panwright::terrain::slopes_test
