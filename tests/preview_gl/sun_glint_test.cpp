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

TEST(SunGlint, FlatPlate) {
  for (const Brdf brdf : {Brdf::beckmann, Brdf::ggx}) {
    double worst = 0, worst_peak = 0, worst_sum = 0;
    for (const Long slope : {0.001L, 0.01L, 0.03L})
      for (const double theta : {0.0, 45.0, 85.0}) {
        const double angle = theta * kDegree;
        const Lobe lobe{brdf, slope, slope, 1.5L};
        const pan::Model model = model_of(single(plate(8, 8), material_of(lobe)));
        constexpr std::uint32_t kSide = 81;
        View view = looking_from({std::sin(angle), 1e-9, std::cos(angle)}, 1, 2 * kDegree, kSide);
        view.to_sun = Vec3(-std::sin(angle), 0, std::cos(angle));
        RenderOptions options;
        options.samples = 1;
        options.shadow_side = 0;
        const image::Image image = rendered(model, view, options);
        expect_no_nan(image);
        double largest = 0, error = 0, sum[2] = {0, 0}, peak = 0;
        for (std::uint32_t i = 0; i < kSide; ++i)
          for (const bool row : {false, true}) {
            const std::uint32_t x = row ? i : kSide / 2, y = row ? kSide / 2 : i;
            const Vec3 v = -pixel_ray(view.camera, {x + 0.5, y + 0.5}).direction;
            const auto want = static_cast<double>(
                over_disc(lobe, dir(view.to_sun), dir(v), disc_quadrature::kRadius, 0));
            const auto got = static_cast<double>(image.radiance[3 * (std::size_t{y} * kSide + x)]);
            largest = std::max(largest, want);
            error = std::max(error, std::fabs(got - want));
            if (i == kSide / 2) peak = std::fabs(got / want - 1);
            sum[0] += want;
            sum[1] += got;
          }
        worst = std::max(worst, error / largest);
        worst_peak = std::max(worst_peak, peak);
        worst_sum = std::max(worst_sum, std::fabs(sum[1] / sum[0] - 1));
        if (error > 0.02 * largest)
          printf("slope %g, %g deg: peak %.1e, profile %.1e\n", static_cast<double>(slope), theta,
                 peak, error / largest);
      }
    printf("%s: peak %.1e, profile %.1e, sum %.1e\n", brdf == Brdf::ggx ? "ggx" : "beckmann",
           worst_peak, worst, worst_sum);
    EXPECT_LE(worst_peak, 0.02);
    EXPECT_LE(worst, 0.02);
    EXPECT_LE(worst_sum, 0.01);
  }
}

}  // namespace
}  // namespace panwright::preview::sun_glint_test
