// Far spheres against closed forms (physics: spheres).
#include "reference_models.h"
#include "tests/support/oracles.h"

namespace panwright::preview {
namespace {

using namespace testing_support;

// 1 − (projected area of the mesh / π), seen from where the camera stands.
TEST(ReferenceSpheres, Lambert) {
  const pan::Model model = model_of(single(sphere(700, 700), lambert(0.8)));
  for (const double degrees : {0.0, 30.0, 60.0, 90.0, 120.0}) {
    const double phase = degrees * kDegree;
    const double distance = 1e5;
    const View view = looking_from({0, -1, 0}, distance, 0.0014 * kDegree, 1024, phase);
    const ReferenceImage result = traced(model, view, direct_light(16));
    const double exact = 0.8 * oracles::lambert_sphere_intensity(phase);
    const double flux = result.flux.x * distance * distance / exact - 1;
    const double summed = intensity(result.image, view.camera, distance) / exact - 1;
    const double radius = view.camera.focal.x / distance;
    const Vec2 centre = photocentre(result.image) -
                        Vec2(512 + radius * oracles::lambert_sphere_photocentre(phase), 512);
    printf(
        "phase %3.0f: flux %+.2e (image %+.2e, error %.1e), photocentre %+.2e %+.2e R; "
        "%.2f s, %.2f M camera rays/s, %.2f M shadow\n",
        degrees, flux, summed, result.flux_error.x / result.flux.x, centre.x / radius,
        centre.y / radius, result.seconds, 1e-6 * result.camera_rays / result.seconds,
        1e-6 * result.shadow_rays / result.seconds);
    EXPECT_LE(std::fabs(flux), 1e-4);
    EXPECT_NEAR(summed, flux, 1e-6);
    EXPECT_LE(glm::length(centre) / radius, 1e-3);
    expect_no_nan(result.image);
  }
}

}  // namespace
}  // namespace panwright::preview
