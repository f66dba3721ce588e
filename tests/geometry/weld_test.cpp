#include "geometry/internal/weld.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shapes.h"

namespace panwright::geometry::weld_test {
namespace {

// Against a double loop.
TEST(Weld, FirstOccurrence) {
  shapes::Random random(3);
  std::vector<Vec3> positions;
  const double unique_positions[] = {0.0, -0.0, 1.0, std::nan(""), HUGE_VAL, 5e-324};
  for (int i = 0; i < 600; ++i)
    positions.push_back({unique_positions[int(random() * 6)], unique_positions[int(random() * 6)],
                         unique_positions[int(random() * 6)]});
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  const std::vector<std::uint32_t> first = welded(positions);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    std::uint32_t expected = 0;
    while (!(same(positions[expected].x, positions[i].x) &&
             same(positions[expected].y, positions[i].y) &&
             same(positions[expected].z, positions[i].z)))
      ++expected;
    EXPECT_EQ(first[i], expected);
  }
  EXPECT_EQ(first, welded_by_sorting(positions));
}

TEST(Weld, SortingAgreesOnASphere) {
  const Mesh mesh = shapes::sphere(40, 50, 1, true);
  EXPECT_EQ(welded(mesh.positions), welded_by_sorting(mesh.positions));
}

}  // namespace
}  // namespace panwright::geometry::weld_test
