// The exposure that --ev auto chooses.

#include "workspace/exposure.h"

#include <gtest/gtest.h>

#include <cmath>

namespace panwright::workspace::exposure_test {
namespace {

// Radiance 1 to 1000, in steps, in a shuffled order; background around them.
image::Image ramp(float scale) {
  image::Image image;
  image.width = 40;
  image.height = 50;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const bool lit = i % 2 == 0;
    const float value = lit ? scale * static_cast<float>(1 + (i / 2 * 377) % 1000) : 0.0f;
    image.radiance.insert(image.radiance.end(), {0.5f * value, value, 0.0f});
    image.coverage.push_back(lit ? 1.0f : 0.0f);
  }
  return image;
}

TEST(AutoExposure, PutsThe99thPercentileNearTheBrightEnd) {
  for (const float scale : {1e-6f, 1.0f, 1e4f}) {
    const double ev = auto_exposure(ramp(scale), 0);
    // the 99th of a hundred steps from 1 to 1000 is 990
    const double shown = 3.14159265358979 * 990 * scale * std::exp2(ev);
    EXPECT_NEAR(std::log2(shown / 0.8), 0, 1.0 / 16 + 0.002) << "rounded to 1/8 of a stop";
    EXPECT_EQ(8 * ev, std::round(8 * ev));
  }
}

TEST(AutoExposure, IsOfTheModelAndNotOfTheSun) {
  // 1,024 times the irradiance, which --ev does not count
  EXPECT_EQ(auto_exposure(ramp(1.0f), 0), auto_exposure(ramp(1024.0f), 10));
}

TEST(AutoExposure, LooksAtLitPixelsAlone) {
  image::Image image = ramp(1.0f);
  const double ev = auto_exposure(image, 0);
  // half a pixel of a target is as bright as a whole one
  for (std::size_t i = 0; i < image.pixels(); i += 4) {
    image.coverage[i] *= 0.5f;
    for (int k = 0; k < 3; ++k) image.radiance[3 * i + static_cast<std::size_t>(k)] *= 0.5f;
  }
  EXPECT_EQ(auto_exposure(image, 0), ev);
  image.radiance.assign(image.radiance.size(), 0.0f);
  EXPECT_EQ(auto_exposure(image, 0), 0) << "nothing is lit";
}

}  // namespace
}  // namespace panwright::workspace::exposure_test
