// Far spheres against closed forms (physics: spheres).
#include "materials/brdf.h"
#include "reference_models.h"
#include "tests/support/oracles.h"

namespace panwright::preview::spheres_test {
namespace {

using namespace testing_support;

// so fine that its outline encloses 1 − 7e-6 of the disc
const pan::Model& fine_sphere(const materials::Material& material) {
  static std::map<double, pan::Model> models;
  const double key = material.weights.y + materials::slopes_of(material).value_or(Vec2(0.5)).x;
  const auto found = models.find(key);
  if (found != models.end()) return found->second;
  return models.emplace(key, model_of(single(sphere(700, 700), material))).first->second;
}

materials::Material beckmann(double slope) {
  materials::Material material;
  material.weights = Vec3(0, 1, 0);
  material.specular = Vec3(1);
  material.specular_brdf = materials::CookTorrance{.alpha = slope};
  return material;
}

constexpr double kDistance = 1e5;  // radii

// A sphere of 210 pixels in radius.
View far_view(double phase) {
  return looking_from({0, -1, 0}, kDistance, 0.0014 * kDegree, 512, phase);
}

struct Against {
  double flux = 0;    // relative
  double centre = 0;  // radii
};

Against compared(const ReferenceImage& result, const View& view, double intensity_exact,
                 double centre_exact) {
  const double radius = view.camera.focal.x / kDistance;
  const Vec2 off = photocentre(result.image) - Vec2(256 + radius * centre_exact, 256);
  const double flux = result.flux.x * kDistance * kDistance / intensity_exact - 1;
  // the total is that of the image
  EXPECT_NEAR(intensity(result.image, view.camera, kDistance) / intensity_exact - 1, flux, 1e-6);
  expect_no_nan(result.image);
  return {flux, glm::length(off) / radius};
}

void expect_lambert_sphere(double degrees) {
  const double phase = degrees * kDegree;
  const View view = far_view(phase);
  const ReferenceImage result = traced(fine_sphere(lambert(0.8)), view, direct_light(32));
  const Against off = compared(result, view, 0.8 * oracles::lambert_sphere_intensity(phase),
                               oracles::lambert_sphere_photocentre(phase));
  printf("phase %3.0f: flux %+.2e (error %.1e), photocentre %.2e R\n", degrees, off.flux,
         result.flux_error.x / result.flux.x, off.centre);
  EXPECT_LE(std::fabs(off.flux), 1e-4);
  EXPECT_LE(off.centre, 1e-3);
}

TEST(ReferenceSpheres, Lambert) {
  for (const double degrees : {0.0, 60.0, 120.0}) expect_lambert_sphere(degrees);
}

TEST(ReferenceSpheres, LambertBetween) {
  for (const double degrees : {30.0, 90.0}) expect_lambert_sphere(degrees);
}

TEST(ReferenceSpheres, BeckmannMirror) {
  const double slope = 0.15;
  const pan::Model& model = fine_sphere(beckmann(slope));
  for (const double degrees : {0.0, 30.0, 60.0, 90.0}) {
    const double phase = degrees * kDegree;
    const View view = far_view(phase);
    const ReferenceImage result = traced(model, view, direct_light(16));
    const double exact = oracles::beckmann_sphere_intensity(slope, phase);
    // the photocentre is the mirror point's, drawn in by the tails: R·sin(α/2)/(4·I)
    const Against off = compared(result, view, exact, std::sin(phase / 2) / (4 * exact));
    printf("phase %3.0f: flux %+.2e (error %.1e), photocentre %.2e R\n", degrees, off.flux,
           result.flux_error.x / result.flux.x, off.centre);
    EXPECT_LE(std::fabs(off.flux), 1e-4);
    EXPECT_LE(off.centre, 1e-3);
  }
}

TEST(ReferenceSpheres, LommelSeeliger) {
  materials::Material material;
  material.diffuse_brdf = materials::LommelSeeliger{1};
  material.diffuse = Vec3(1);
  materials::fit(material);
  const pan::Model model = model_of(single(sphere(700, 700), material));
  struct Case {
    double degrees, intensity, centre;
  };
  // I = (w/8)·[1 − sin(α/2)·tan(α/2)·ln cot(α/4)], and photocentres by quadrature
  for (const Case& c : {Case{60, 0.0774783752, 0.37817545}, {90, 0.0470968450, 0.56321870}}) {
    const View view = far_view(c.degrees * kDegree);
    const ReferenceImage result = traced(model, view, direct_light(64));
    const Against off = compared(result, view, c.intensity, c.centre);
    printf("phase %3.0f: flux %+.2e (error %.1e), photocentre %.2e R\n", c.degrees, off.flux,
           result.flux_error.x / result.flux.x, off.centre);
    EXPECT_LE(std::fabs(off.flux), 1e-4);
    EXPECT_LE(off.centre, 1e-3);
  }
}

// The BRDF itself is held by the tests of materials: here it is summed over the sphere.
TEST(ReferenceSpheres, Eon) {
  materials::Material material = lambert(0.8);
  material.diffuse_brdf = materials::Eon{0.7};
  materials::fit(material);
  const pan::Model model = model_of(single(sphere(700, 700), material));
  for (const double degrees : {0.0, 60.0}) {
    const double phase = degrees * kDegree;
    const Vec3 to_viewer(0, 0, 1);
    const Vec3 to_light(std::sin(phase), 0, std::cos(phase));
    // midpoints of equal areas of the seen hemisphere's disc
    constexpr int kRings = 600;
    double exact = 0;
    for (int i = 0; i < kRings; ++i)
      for (int j = 0; j < 2 * kRings; ++j) {
        const double r = std::sqrt((i + 0.5) / kRings);
        const double turn = kPi * (j + 0.5) / kRings;
        const Vec3 normal(r * std::cos(turn), r * std::sin(turn), std::sqrt(1 - r * r));
        const double cosine = glm::dot(normal, to_light);
        if (cosine > 0)
          exact += materials::f64::brdf(material, to_light, to_viewer, normal).x * cosine;
      }
    exact *= kPi / (2.0 * kRings * kRings);
    const View view = far_view(phase);
    const ReferenceImage result = traced(model, view, direct_light(64));
    const double flux = result.flux.x * kDistance * kDistance / exact - 1;
    printf("phase %3.0f: flux %+.2e (error %.1e)\n", degrees, flux,
           result.flux_error.x / result.flux.x);
    EXPECT_LE(std::fabs(flux), 1e-4);
  }
}

// A mirror shows the Sun's image: an intensity of R²/4, no darker for its disc. From where the Sun
// stands, for elsewhere the image, smaller than a facet, is by as much too large or small as the
// facet and its normals lean apart, up to 3e-3.
TEST(ReferenceSpheres, Mirror) {
  materials::Material material;
  material.weights = Vec3(0, 1, 0);
  material.specular = Vec3(1, 0.5, 0.25);
  material.specular_brdf = materials::Mirror{};
  const pan::Model model = model_of(single(sphere(700, 700), material));
  View view = looking_from({0, -1, 0}, kDistance, 0.0014 * kDegree, 64);
  const double radius = 32 / 0.006;  // pixels
  view.camera.focal = Vec2(radius * kDistance);
  for (const double darkening : {0.0, 0.6}) {
    ReferenceOptions options;
    options.bounces = 1;
    options.samples = 256;
    const ReferenceImage result = traced(model, view, options, darkening);
    const Vec3 flux = result.flux * (kDistance * kDistance);
    printf("u = %.1f: flux %+.2e (error %.1e)\n", darkening, 4 * flux.x - 1,
           result.flux_error.x / result.flux.x);
    EXPECT_NEAR(4 * flux.x, 1, 4 * result.flux_error.x / result.flux.x + 1e-4);
    EXPECT_LE(result.flux_error.x / result.flux.x, 1e-3);
    EXPECT_NEAR(flux.y / flux.x, 0.5, 1e-7);
    EXPECT_NEAR(flux.z / flux.x, 0.25, 1e-7);
  }
}

// A lobe far narrower than the Sun's disc reflects an image of it: only directions taken by the
// lobe find it, and the flux stays what it is for any source that small.
TEST(ReferenceSpheres, NarrowLobeSeesTheDisc) {
  for (const double slope : {1e-4, 3e-3, 0.02}) {
    const pan::Model model = model_of(single(sphere(700, 700), beckmann(slope)));
    // only what reflects the disc: the image is 8 times as wide as it, or as the lobe
    View view = looking_from({0, -1, 0}, kDistance, 0.0014 * kDegree, 256);
    const double radius = 128 / (4 * std::max(slope, 0.0024));  // pixels
    view.camera.focal = Vec2(radius * kDistance);
    ReferenceOptions options;
    options.bounces = 0;
    options.samples = 64;
    const ReferenceImage result = traced(model, view, options);
    const double exact = oracles::beckmann_sphere_intensity(slope, 0);
    const double flux = result.flux.x * kDistance * kDistance;
    printf("slope %.0e: flux %+.2e (error %.1e)\n", slope, flux / exact - 1,
           result.flux_error.x / result.flux.x);
    EXPECT_NEAR(flux, exact, 4 * result.flux_error.x * kDistance * kDistance + 2e-4 * exact);
    EXPECT_LE(result.flux_error.x, 2e-3 * result.flux.x);
  }
}

// The whole disc shines a little around the terminator: 1 + O(ρ²).
TEST(ReferenceSpheres, SunDiscHardlyChangesALambertSphere) {
  const pan::Model& model = fine_sphere(lambert(0.8));
  const View view = far_view(90 * kDegree);
  ReferenceOptions options = direct_light(64);
  const ReferenceImage point = traced(model, view, options);
  options.sun_disc = true;
  const ReferenceImage disc = traced(model, view, options);
  const ReferenceImage darkened = traced(model, view, options, 0.6);
  const double error = std::hypot(point.flux_error.x, disc.flux_error.x) / point.flux.x;
  printf("disc %+.2e, darkened %+.2e (error %.1e)\n", disc.flux.x / point.flux.x - 1,
         darkened.flux.x / point.flux.x - 1, error);
  EXPECT_NEAR(disc.flux.x / point.flux.x, 1, 4 * error + 3e-5);
  EXPECT_NEAR(darkened.flux.x / point.flux.x, 1, 4 * error + 3e-5);
}

}  // namespace
}  // namespace panwright::preview::spheres_test
