// The Sun's glint on a flat plate: pixels along the plane of incidence and across it against a
// quadrature over the Sun's disc.
#include "models.h"
#include "tests/support/disc_quadrature.h"

namespace panwright::preview::sun_glint_test {
namespace {

using namespace testing_support;
using disc_quadrature::Brdf;
using disc_quadrature::Dir;
using disc_quadrature::Lobe;
using disc_quadrature::Long;
using disc_quadrature::over_disc;

Dir dir(const Vec3& v) { return {v.x, v.y, v.z}; }

materials::Material material_of(const Lobe& lobe) {
  materials::Material m;
  m.diffuse = Vec3(0);
  m.specular = Vec3(1);
  m.weights = Vec3(0, 1, 0);
  m.refract = Vec3(static_cast<double>(lobe.index));
  const auto slope = static_cast<double>(lobe.ax);
  m.specular_brdf = materials::with_slopes(
      lobe.brdf == Brdf::ggx ? materials::SpecularModel::ggx : materials::SpecularModel::beckmann,
      Vec2(slope));
  materials::fit(m);
  return m;
}

struct Residuals {
  double peak = 0;     // relative, at the specular direction
  double profile = 0;  // over the largest, along the plane of incidence and across it
  double sum = 0;      // relative, of both
};

// theta: of Sun and camera, degrees; field: of the camera about the specular direction
Residuals residuals(const Lobe& lobe, double theta, double field) {
  const double angle = theta * kDegree;
  const pan::Model model = model_of(single(plate(8, 8), material_of(lobe)));
  constexpr std::uint32_t kSide = 81;
  View view = looking_from({std::sin(angle), 1e-9, std::cos(angle)}, 1, field * kDegree, kSide);
  view.to_sun = Vec3(-std::sin(angle), 0, std::cos(angle));
  RenderOptions options;
  options.samples = 1;
  options.shadow_side = 0;
  const image::Image image = rendered(model, view, options);
  expect_no_nan(image);
  double largest = 0, error = 0, sum[2] = {0, 0};
  Residuals r;
  for (std::uint32_t i = 0; i < kSide; ++i)
    for (const bool row : {false, true}) {
      const std::uint32_t x = row ? i : kSide / 2, y = row ? kSide / 2 : i;
      const Vec3 v = -pixel_ray(view.camera, {x + 0.5, y + 0.5}).direction;
      const auto want = static_cast<double>(
          over_disc(lobe, dir(view.to_sun), dir(v), disc_quadrature::kRadius, 0));
      const auto got = static_cast<double>(image.radiance[3 * (std::size_t{y} * kSide + x)]);
      largest = std::max(largest, want);
      error = std::max(error, std::fabs(got - want));
      if (i == kSide / 2) r.peak = std::fabs(got / want - 1);
      sum[0] += want;
      sum[1] += got;
    }
  r.profile = error / largest;
  r.sum = std::fabs(sum[1] / sum[0] - 1);
  return r;
}

// The largest of each, printed.
Residuals worst_of(Brdf brdf, std::initializer_list<Long> slopes,
                   std::initializer_list<double> thetas, double field) {
  Residuals worst;
  for (const Long slope : slopes)
    for (const double theta : thetas) {
      const Residuals r = residuals({brdf, slope, slope, 1.5L}, theta, field);
      printf("slope %g, %g deg: peak %.1e, profile %.1e, sum %.1e\n", static_cast<double>(slope),
             theta, r.peak, r.profile, r.sum);
      worst = {std::max(worst.peak, r.peak), std::max(worst.profile, r.profile),
               std::max(worst.sum, r.sum)};
    }
  return worst;
}

TEST(SunGlint, FlatPlate) {
  for (const Brdf brdf : {Brdf::beckmann, Brdf::ggx}) {
    const Residuals worst = worst_of(brdf, {0.001L, 0.01L, 0.03L}, {0.0, 45.0, 85.0}, 2);
    EXPECT_LE(worst.peak, 0.02);
    EXPECT_LE(worst.profile, 0.02);
    EXPECT_LE(worst.sum, 0.01);
  }
}

// Towards grazing incidence the disc is as wide across the plane of incidence as wide lobes are.
TEST(SunGlint, WideLobesAtGrazingIncidence) {
  for (const Brdf brdf : {Brdf::beckmann, Brdf::ggx}) {
    const Residuals worst =
        worst_of(brdf, {0.15L, 0.2L, 0.3L, 0.5L}, {80.0, 88.0, 89.0, 89.5}, 0.4);
    // measured 1.2e-2, 2.8e-2 and 1.3e-2, all of slope 0.5 at 89.5 degrees; under a point Sun lobes
    // of 0.15 are 1.05, 1.19 and 1.74 times too bright
    EXPECT_LE(worst.peak, 0.02);
    EXPECT_LE(worst.profile, 0.035);
    EXPECT_LE(worst.sum, 0.02);
  }
}

}  // namespace
}  // namespace panwright::preview::sun_glint_test
