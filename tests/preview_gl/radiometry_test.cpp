// Images against closed forms and facet sums (physics: Lambert plates and spheres, facet sums).
#include "models.h"

namespace panwright::preview::radiometry_test {
namespace {

using namespace testing_support;

// E·ρ·(2/3π)·(sin α + (π−α)·cos α)·R²: the intensity of a far Lambert sphere.
double lambert_sphere(double albedo, double phase) {
  return albedo * 2 / (3 * kPi) * (std::sin(phase) + (kPi - phase) * std::cos(phase));
}

// Its photocentre's offset towards the Sun, in radii.
double lambert_photocentre(double phase) {
  return 3 * kPi / 16 * std::sin(phase) * (1 + std::cos(phase)) /
         (std::sin(phase) + (kPi - phase) * std::cos(phase));
}

// ∫ over the triangles of f·(n·l)⁺·(n·v)⁺ dA for Lambert facets.
double facet_sum(const pan::Model& model, double albedo, const Vec3& to_sun,
                 const Vec3& to_viewer) {
  const pan::MeshView mesh = model.mesh(0);
  const auto at = [&](std::size_t i) {
    const auto& p = mesh.positions[mesh.indices[i]];
    return Vec3(p.x, p.y, p.z);
  };
  double sum = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Vec3 twice_area = glm::cross(at(i + 1) - at(i), at(i + 2) - at(i));
    const double lit = glm::dot(twice_area, to_sun);
    const double seen = glm::dot(twice_area, to_viewer);
    if (lit > 0 && seen > 0) sum += lit * seen / (2 * glm::length(twice_area));
  }
  return albedo / kPi * sum;
}

TEST(Radiometry, LambertPlate) {
  const pan::Model model = model_of(single(plate(1.5, 0.8), lambert(0.6)));
  RenderOptions options;
  options.samples = 8;
  struct Case {
    Vec3 from;
    Vec3 sun;
  };
  for (const Case& c : {Case{{0, 0, 1}, {0, 0, 1}}, Case{{1, 2, 3}, {-1, 0.5, 2}},
                        Case{{3, -1, 0.5}, {0.1, 0.2, 1}}}) {
    const double distance = 1e5;
    View view = looking_from(c.from, distance, 2e-5, 512);
    view.camera.world_from_camera =
        view.camera.world_from_camera * glm::angleAxis(0.3, Vec3(0, 0, 1));
    view.to_sun = c.sun;
    const image::Image image = rendered(model, view, options);
    const double exact = 0.6 / kPi * 1.5 * 0.8 * glm::normalize(c.sun).z * glm::normalize(c.from).z;
    EXPECT_NEAR(intensity(image, view.camera, distance) / exact, 1, 2e-5);
    expect_no_nan(image);
  }
}

TEST(Radiometry, OpenPlateIsTheSameFromBehind) {
  const pan::Model model = model_of(single(plate(1, 1), lambert(1)));
  for (const double side : {1.0, -1.0}) {
    View view = looking_from({0, 0.3, side}, 100, 0.02, 64);
    view.to_sun = {0, 0, side};
    const image::Image lit = rendered(model, view);
    view.to_sun = {0, 0, -side};
    const image::Image dark = rendered(model, view);
    const std::size_t centre = std::size_t{32} * 64 + 32;
    EXPECT_NEAR(lit.radiance[3 * centre] * kPi, 1, 3e-7);
    EXPECT_EQ(dark.radiance[3 * centre], 0);
    EXPECT_EQ(dark.coverage[centre], 1);
  }
}

// The far sphere with smooth normals on 400 × 400 quads, 419 pixels in radius.
TEST(Radiometry, FarLambertSphere) {
  const pan::Model model = model_of(single(sphere(400, 400), lambert(0.8)));
  for (const double degrees : {0.0, 60.0, 90.0}) {
    const double phase = degrees * kDegree;
    const double distance = 1e5;
    const View view = looking_from({0, -1, 0}, distance, 0.0014 * kDegree, 1024, phase);
    const image::Image image = rendered(model, view);
    const double flux = intensity(image, view.camera, distance) / lambert_sphere(0.8, phase) - 1;
    const double radius = view.camera.focal.x / distance;
    const Vec2 centre = photocentre(image) - Vec2(512 + radius * lambert_photocentre(phase), 512);
    printf("phase %2.0f: flux %+.2e, photocentre %+.2e %+.2e px\n", degrees, flux, centre.x,
           centre.y);
    EXPECT_LE(std::fabs(flux), 5e-4);
    EXPECT_LE(glm::length(centre), 0.02);
    expect_no_nan(image);
  }
}

TEST(Radiometry, FlatSphereIsItsFacetSum) {
  const pan::Model model = model_of(single(sphere(100, 60), lambert(0.8)));
  for (const double degrees : {0.0, 60.0, 90.0}) {
    const double distance = 1e5;
    const View view = looking_from({0, -1, 0}, distance, 0.0014 * kDegree, 1024, degrees * kDegree);
    RenderOptions options;
    options.flat = true;
    const double exact =
        facet_sum(model, 0.8, glm::normalize(view.to_sun), glm::normalize(view.camera.position));
    const image::Image image = rendered(model, view, options);
    const double flux = intensity(image, view.camera, distance) / exact - 1;
    printf("phase %2.0f: flat flux against facet sum %+.2e\n", degrees, flux);
    EXPECT_LE(std::fabs(flux), 1e-4);
  }
}

TEST(Radiometry, IntensityDoesNotDependOnDistance) {
  const pan::Model model = model_of(single(sphere(200, 200), lambert(1)));
  RenderOptions options;
  options.samples = 4;
  double first = 0;
  for (const double distance : {1e2, 1e4, 1e6, 1e8}) {
    const double fov = 2 * std::atan(1.25 / distance);
    const View view = looking_from({1, -2, 0.5}, distance, fov, 256, 60 * kDegree);
    const image::Image image = rendered(model, view, options);
    // finite distance: +0.23·R/d is the 30° figure, -… at 60°; only the far ones are held together
    const double value = intensity(image, view.camera, distance);
    printf("d %.0e: I %.7f\n", distance, value);
    if (distance == 1e4) first = value;
    if (distance > 1e4) {
      EXPECT_NEAR(value / first, 1, 1e-4) << distance;
    }
  }
  EXPECT_NEAR(first / lambert_sphere(1, 60 * kDegree), 1, 1e-3);
}

}  // namespace
}  // namespace panwright::preview::radiometry_test
