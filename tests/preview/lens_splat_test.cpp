// Texels behind lenses on pixels.

#include "preview/frame/lens_splat.h"

#include <gtest/gtest.h>

namespace panwright::preview::lens_splat_test {
namespace {

// Areas are differences of sums: cells beside a texel may have a last digit below 0, of which no
// pixel's radiance may be made.
TEST(LensSplat, RoundingLeavesNoNegativeRadiance) {
  LensLight light{{10, 10, 8, 8}, 1, std::vector<double>(4 * 64, 0.0)};
  for (std::size_t k = 0; k < 4; ++k) {
    light.light[4 * 9 + k] = 1;
    light.light[4 * 54 + k] = -3e-17;
  }
  image::Image image;
  image.width = image.height = 32;
  image.radiance.assign(3 * image.pixels(), 0.0f);
  image.coverage.assign(image.pixels(), 0.0f);
  put(light, 0.4, image);
  double sum = 0;
  for (const float value : image.radiance) {
    EXPECT_GE(value, 0);
    sum += static_cast<double>(value);
  }
  for (const float value : image.coverage) EXPECT_GE(value, 0);
  EXPECT_NEAR(sum, 3, 1e-6);
}

}  // namespace
}  // namespace panwright::preview::lens_splat_test
