#include <gtest/gtest.h>

#include "tests/materials/quadrature.h"
#include "tests/support/hard_cases.h"

namespace panwright::materials::blinn_phong_test {
namespace {

// Seen along the normal, all light comes back.
TEST(BlinnPhong, AlbedoAtNormalIncidenceIsOne) {
  const auto nodes = gauss(60);
  for (int shine = 0; shine <= 1000; ++shine) {
    double sum = 0;
    // panels that halve towards the highlight
    double inner = 0;
    for (double outer = 0x1p-20; outer <= 1; inner = outer, outer *= 2)
      for (const auto& [x, w] : nodes) {
        const double versine = inner + (outer - inner) * x;  // 1 - cos θ
        const Vec3 l(std::sqrt(versine * (2 - versine)), 0, 1 - versine);
        const double s = shine;
        sum += w * (outer - inner) * 2 * kPi * l.z *
               f64::blinn_phong(s, l, Vec3(0, 0, 1), Vec3(0, 0, 1));
      }
    ASSERT_NEAR(sum, 1, 1e-12) << shine;  // measured 2.7e-15
  }
}

TEST(BlinnPhong, PowerOfTheHalfVector) {
  for (const double shine : {0.0, 1.0, 20.0, 500.0}) {
    double worst = 0;
    for (const auto& pair : hard_cases::random_pairs(0.01, 2000)) {
      const Vec3 l = glm::normalize(Vec3(pair.l)), v = glm::normalize(Vec3(pair.v));
      const double scale =
          (shine + 2) * (shine + 4) / (8 * kPi * (std::pow(2, -shine / 2) + shine));
      const double want = scale * std::pow(glm::normalize(l + v).z, shine);
      if (want < 1e-25) continue;
      const double got = f64::blinn_phong(shine, l, v, Vec3(0, 0, 1));
      worst = std::max(worst, std::fabs(got - want) / want);
    }
    EXPECT_LE(worst, 1e-15 * (4 + shine)) << shine;
  }
}

}  // namespace
}  // namespace panwright::materials::blinn_phong_test
