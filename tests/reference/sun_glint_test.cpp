// Flat plates with narrow lobes under the Sun's disc, out to the flanks, against a quadrature over
// the disc.
#include "reference_models.h"
#include "tests/support/disc_quadrature.h"

namespace panwright::preview::sun_glint_test {
namespace {

using namespace testing_support;
using disc_quadrature::Brdf;
using disc_quadrature::Lobe;
using disc_quadrature::Long;
using disc_quadrature::over_disc;

// Beside the disc only the lobe's flank is seen, of which even samples of the disc find little: the
// mean was 0.24 of the truth at a slope of 0.003, 80° and 0.5° out of the plane of incidence.
TEST(ReferenceSunGlint, FlanksOfNarrowLobes) {
  for (const Long slope : {0.001L, 0.003L, 0.01L})
    for (const double theta : {30.0, 80.0}) {
      const double angle = theta * kDegree;
      materials::Material m;
      m.diffuse = Vec3(0);
      m.specular = Vec3(1);
      m.weights = Vec3(0, 1, 0);
      m.refract = Vec3(1.5);
      m.specular_brdf =
          materials::with_slopes(materials::SpecularModel::beckmann, Vec2(double(slope)));
      materials::fit(m);
      const pan::Model model = model_of(single(plate(8, 8), m));
      // one pixel each, as narrow as the flank
      for (const Vec2& place :
           {Vec2(0, 0), Vec2(0.2, 0.1), Vec2(0, 0.3), Vec2(0.4, 0), Vec2(0, 0.5)}) {
        const double in = angle + place.x * kDegree, out = place.y * kDegree;
        const Vec3 v(std::sin(in) * std::cos(out), std::sin(out), std::cos(in) * std::cos(out));
        const Vec3 to_sun(-std::sin(angle), 0, std::cos(angle));
        const auto want = static_cast<double>(
            over_disc(Lobe{Brdf::beckmann, slope, slope, 1.5L},
                      {-std::sin(Long(angle)), 0, std::cos(Long(angle))},
                      {std::sin(Long(in)) * std::cos(Long(out)), std::sin(Long(out)),
                       std::cos(Long(in)) * std::cos(Long(out))},
                      disc_quadrature::kRadius, 0.6L));
        if (want < 1e-12) continue;
        View view = looking_from(v, 1, 1e-7, 1);
        view.to_sun = to_sun;
        ReferenceOptions options;
        options.bounces = 0;
        options.samples = 1024;
        const ReferenceImage result = traced(model, view, options, 0.6);
        const auto got = static_cast<double>(result.image.radiance[0]);
        const auto error = static_cast<double>(result.standard_error[0]);
        printf("slope %g, %g deg, (%g, %g): %.3e, off by %+.1e, error %.1e\n", double(slope), theta,
               place.x, place.y, want, got / want - 1, error / want);
        EXPECT_NEAR(got, want, 4 * error + 2e-3 * want);
        EXPECT_LE(error, 0.05 * want);
      }
    }
}

}  // namespace
}  // namespace panwright::preview::sun_glint_test
