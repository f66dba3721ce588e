// Lenses with distortion in OpenGL: closed forms, the pinhole, and the reference's rays.
#include "preview/frame/lens_splat.h"
#include "preview/frame/lens_views.h"
#include "preview/lens_renderer.h"
#include "tests/reference/lens_cases.h"

namespace panwright::preview::lens_test {
namespace {

using namespace testing_support;
using panwright::testing_support::world_of;

// A unit sphere at a place of the camera's axes, the Sun to its upper left.
View sphere_at(const LensCase& each, const Vec3& place) {
  View view = sphere_through(each, place);
  view.to_sun = view.camera.world_from_camera * Vec3(-0.5, -0.4, -1);
  return view;
}

image::Image through_lens(const world::World& world, const world::Camera& camera,
                          const RenderOptions& options, SamplingReport* report = nullptr) {
  DiagnosticLog log;
  Renderer renderer(shared_device());
  LensRenderer lens;
  auto image = lens.render(renderer, world, camera, options, log);
  EXPECT_TRUE(image) << to_text(log);
  if (report) *report = lens.sampling();
  return image ? std::move(*image) : image::Image{};
}

RenderOptions automatic(double error = 0.02) {
  RenderOptions options;
  options.samples = 0;
  options.pixel_error = error;
  options.shadows = Shadows::hard;
  return options;
}

struct Disc {
  double area = 0;  // pixels
  Vec2 centre{0};
};

// The image of a unit sphere's rim, as a polygon of its places.
Disc rim_of(const world::Camera& camera, const Vec3& centre) {
  constexpr int kSides = 20000;
  const double distance = glm::length(centre), sine = 1 / distance;
  const Vec3 axis = centre / distance;
  const Vec3 u = glm::normalize(glm::cross(axis, Vec3(0.3, 1, 0.2))), v = glm::cross(axis, u);
  Disc disc;
  Vec2 first, before;
  for (int k = 0; k <= kSides; ++k) {
    const double angle = 2 * kPi * k / kSides;
    const auto place = camera.distortion->place(std::sqrt(1 - sine * sine) * axis +
                                                sine * (std::cos(angle) * u + std::sin(angle) * v));
    EXPECT_TRUE(place);
    const Vec2 at = camera.focal * *place + camera.principal;
    if (k == 0) first = at;
    const Vec2 a = before - first, b = at - first;
    if (k > 0) {
      const double area = 0.5 * (a.x * b.y - a.y * b.x);
      disc.area += area;
      disc.centre += area * (a + b) / 3.0;
    }
    before = at;
  }
  disc.centre = disc.centre / disc.area + first;
  disc.area = std::fabs(disc.area);
  return disc;
}

Disc covered(const image::Image& image) {
  Disc disc;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const double a = image.coverage[i];
    disc.area += a;
    disc.centre += a * Vec2(static_cast<double>(i % image.width) + 0.5,
                            static_cast<double>(i / image.width) + 0.5);
  }
  disc.centre /= disc.area;
  return disc;
}

// What a sphere covers, in the middle and at the image's corner, from 60 to 0.01 pixels. Facets
// take 1e-4 of the area.
TEST(LensRenderer, SphereCoversItsImage) {
  const pan::Model model = model_of(single(sphere(200, 200), lambert(0.8)));
  for (const LensCase& each : kLensCases)
    for (const Vec3& direction : {Vec3(0.1, -0.05, 1), Vec3(0.6, 0.5, 1)})
      for (const double distance : {3.0, 40.0, 400.0, 20000.0}) {
        const Vec3 place = distance * glm::normalize(direction);
        const View view = sphere_at(each, place);
        const Disc exact = rim_of(view.camera, place);
        if (distance < 40 && direction.x > 0.5) continue;  // beyond the border
        SamplingReport report;
        RenderOptions options = automatic();
        options.flux_error = 1e-4;
        const Disc got =
            covered(through_lens(world_of(model, view), view.camera, options, &report));
        const double miss = glm::length(got.centre - exact.centre);
        printf("%-8s %8.0f m %8.4f px: area %+.1e, centre %.4f px, %zu views of texels\n",
               each.name, distance, std::sqrt(exact.area), got.area / exact.area - 1, miss,
               report.imposters.size());
        EXPECT_NEAR(got.area / exact.area, 1, 5e-4);
        // the light of one pixel is in its middle
        if (std::sqrt(exact.area) > 3) EXPECT_LT(miss, 0.02);
      }
}

// With a PSF, a far target's light keeps its sum and its place.
TEST(LensRenderer, PsfKeepsFluxAndPlaceOfFarTarget) {
  const pan::Model model = model_of(single(sphere(60, 60), lambert(0.8)));
  for (const LensCase& each : kLensCases) {
    const Vec3 place = 2000.0 * glm::normalize(Vec3(0.53, 0.47, 1));
    const View view = sphere_at(each, place);
    const Disc exact = rim_of(view.camera, place);
    RenderOptions options = automatic();
    const double sharp = covered(through_lens(world_of(model, view), view.camera, options)).area;
    options.psf_sigma = 0.8;
    const Disc got = covered(through_lens(world_of(model, view), view.camera, options));
    EXPECT_NEAR(got.area / sharp, 1, 1e-5) << each.name;
    EXPECT_LT(glm::length(got.centre - exact.centre), 5e-3) << each.name;
  }
}

// Without coefficients, texels are the samples of the pinhole.
TEST(LensRenderer, NoCoefficientsGiveThePinhole) {
  const pan::Model model = model_of(single(sphere(40, 40), lambert(0.8)));
  View view = looking_from({1, -2, 0.7}, 5, 0.6, 96, 0.6);
  const world::World world = world_of(model, view);
  RenderOptions options;
  options.samples = 4;
  options.imposters = Imposters::off;
  options.specular_filter = false;
  Renderer renderer(shared_device());
  DiagnosticLog log;
  const auto plain = renderer.render(world, view.camera, options, log);
  ASSERT_TRUE(plain);
  view.camera.distortion = std::make_shared<sensor::DistortionMap>(sensor::Brown{});
  const image::Image image = through_lens(world, view.camera, options);
  double worst = 0;
  for (std::size_t i = 0; i < image.radiance.size(); ++i)
    worst = std::max(worst, std::fabs(double(image.radiance[i]) - double(plain->radiance[i])));
  printf("no coefficients: %.2e of radiance\n", worst);
  EXPECT_LT(worst, bound(2e-6, 1.5e-4));  // 7.1e-5 on an H100
}

// Against the reference's rays: boxes and their shadows, no closed form.
TEST(LensRenderer, AgreesWithTheReference) {
  const pan::Model model = model_of(single(box(Vec3(0.8, 0.5, 0.6)), lambert(0.8)));
  for (const LensCase& each : kLensCases)
    for (const unsigned samples : {0u, 4u}) {
      SCOPED_TRACE(each.name);
      const View view = sphere_at(each, {1, -0.8, 3.4});
      const world::World world = world_of(model, view);
      RenderOptions options = automatic();
      options.samples = samples;
      SamplingReport report;
      const image::Image image = through_lens(world, view.camera, options, &report);
      const image::Image traced_image = traced(world, view.camera, direct_light(256)).image;
      double squares = 0, all = 0, a = 0, b = 0;
      for (std::size_t i = 0; i < image.radiance.size(); ++i) {
        const double x = image.radiance[i], y = traced_image.radiance[i];
        squares += (x - y) * (x - y);
        all += y * y;
        a += x;
        b += y;
      }
      const double rms = std::sqrt(squares / all);
      const double off = glm::length(photocentre(image) - photocentre(traced_image));
      printf("%-8s %u: rms %.4f (said %.4f), flux %+.1e, photocentre %.4f px\n", each.name, samples,
             rms, report.rmse, a / b - 1, off);
      EXPECT_LT(rms, 0.03);
      EXPECT_NEAR(a / b, 1, 2e-3);
      EXPECT_LT(off, 0.02);
      expect_no_nan(image);
    }
}

// Texels of light 1 give pixels of light 1, from one view or many, up to the ends of the domain.
TEST(LensRenderer, TexelsCoverPixelsOnce) {
  for (const LensCase& each : kLensCases)
    for (const double rate : {1.5, 3.0}) {
      SCOPED_TRACE(each.name);
      const world::Camera camera = sphere_at(each, {0, 0, 4}).camera;
      std::vector<LensPart> parts;
      ASSERT_TRUE(divide(camera, {0, 0, 128, 128}, rate, 2e4, parts));
      EXPECT_GT(parts.size(), 1u);
      image::Image image;
      image.width = image.height = 128;
      image.radiance.assign(3 * image.pixels(), 0.0f);
      image.coverage.assign(image.pixels(), 0.0f);
      for (const LensPart& part : parts) {
        image::Image texels;
        texels.width = part.view.camera.width;
        texels.height = part.view.camera.height;
        texels.radiance.assign(3 * texels.pixels(), 1.0f);
        texels.coverage.assign(texels.pixels(), 1.0f);
        LensLight light{part.part, 1, {}};
        splat(camera, part.view, texels, light);
        put(light, 0, image);
      }
      double worst = 0;
      for (std::uint32_t row = 0; row < 128; ++row)
        for (std::uint32_t column = 0; column < 128; ++column) {
          bool whole = true;
          for (unsigned k = 0; k < 4; ++k)
            whole = whole && world::distorted_ray(camera, {column + k % 2, row + k / 2});
          const float* at = image.radiance.data() + 3 * (row * 128 + column);
          if (whole) worst = std::max(worst, std::fabs(double(at[0]) - 1));
          EXPECT_LE(at[0], 1 + 1e-6f);
        }
      EXPECT_LT(worst, 1e-6);  // float32: 1.2e-7
    }
}

// Depths by rays, as the triangles of the id buffer have them.
TEST(LensRenderer, GroundTruthIsThatOfThePinhole) {
  const pan::Model model = model_of(single(box(Vec3(0.8, 0.5, 0.6)), lambert(0.8)));
  View view = looking_from({1, -2, 0.7}, 5, 0.6, 96, 0.6);
  const world::World world = world_of(model, view);
  RenderOptions options;
  options.ground_truth = true;
  Renderer renderer(shared_device());
  DiagnosticLog log;
  const auto plain = renderer.render(world, view.camera, options, log);
  ASSERT_TRUE(plain);
  view.camera.distortion = std::make_shared<sensor::DistortionMap>(sensor::Brown{});
  image::Image image = through_lens(world, view.camera, options);
  Reference reference;
  ASSERT_TRUE(reference.add_ground_truth(world, view.camera, false, image, log));
  int others = 0;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    others += image.target_id[i] != plain->target_id[i] || image.node_id[i] != plain->node_id[i] ||
              image.material_id[i] != plain->material_id[i];
    if (image.target_id[i] == plain->target_id[i] && image.target_id[i] > 0)
      EXPECT_NEAR(image.depth[i], plain->depth[i], 1e-5);
  }
  EXPECT_LE(others, 2);  // outlines through a pixel's centre: 0
}

// Beside and behind the camera, in views of their own.
TEST(LensRenderer, FisheyeSeesBehindItself) {
  const pan::Model model = model_of(single(sphere(200, 200), lambert(0.8)));
  const LensCase fisheye{"fisheye", 24, sensor::Fisheye{}};
  for (const Vec3& place : {Vec3(4, 0, -1), Vec3(1.5, 0, -0.1)})
    for (const unsigned samples : {0u, 4u}) {
      const View view = sphere_at(fisheye, place);
      const Disc exact = rim_of(view.camera, place);
      RenderOptions options = automatic();
      options.samples = samples;
      const Disc got = covered(through_lens(world_of(model, view), view.camera, options));
      EXPECT_NEAR(got.area / exact.area, 1, 2e-3);
      EXPECT_LT(glm::length(got.centre - exact.centre), 0.02);
    }
}

// Lenses of which few pixels see anything, or none.
TEST(LensRenderer, SmallDomainsLeavePixelsEmpty) {
  const pan::Model model = model_of(single(sphere(20, 20), lambert(0.8)));
  const sensor::Distortion lenses[] = {sensor::Brown{{-40}}, sensor::RadialPowers{{-2}},
                                       sensor::Division{1e3}, sensor::Fisheye{{-3}},
                                       sensor::Brown{{1e6, 1e6, 3, -2, 1e9}}};
  for (const sensor::Distortion& lens : lenses)
    for (const Vec3& place : {Vec3(0, 0, 4), Vec3(0, 0, 0.2), Vec3(3, 0, -1)}) {
      const View view = sphere_at({"", 60, lens}, place);
      for (const unsigned samples : {0u, 1u}) {
        RenderOptions options = automatic();
        options.samples = samples;
        options.work = 1e5;
        expect_no_nan(through_lens(world_of(model, view), view.camera, options));
      }
    }
}

// A small target before a large one, and a hidden one, share pixels.
TEST(LensRenderer, SmallTargetBeforeLargeOne) {
  const pan::Model ball = model_of(single(sphere(40, 40), lambert(0.8)));
  const View view = sphere_at(kLensCases[0], {0.4, 0.3, 4});
  world::World world = world_of(ball, view);
  DiagnosticLog log;
  const Quat& q = view.camera.world_from_camera;
  for (const Vec3& place : {Vec3(0.005, 0.02, 0.2), Vec3(1.2, 0.9, 12)}) {
    pan::Contents small = single(sphere(20, 20), lambert(0.3));
    small.nodes[0].scale = Vec3(place.z < 1 ? 0.01 : 0.3);
    const auto added = world.add(place.z < 1 ? "near" : "behind",
                                 panwright::testing_support::shared(model_of(small)), log);
    ASSERT_TRUE(added) << to_text(log);
    world.set_pose(world.size() - 1, {view.camera.position + q * place, Quat(1, 0, 0, 0)});
  }
  const image::Image image = through_lens(world, view.camera, automatic());
  const image::Image exact = traced(world, view.camera, direct_light(256)).image;
  double squares = 0, all = 0;
  for (std::size_t i = 0; i < image.radiance.size(); ++i) {
    const double off = double(image.radiance[i]) - double(exact.radiance[i]);
    squares += off * off;
    all += double(exact.radiance[i]) * double(exact.radiance[i]);
  }
  printf("three targets: rms %.4f\n", std::sqrt(squares / all));
  EXPECT_LT(std::sqrt(squares / all), 0.03);
}

}  // namespace
}  // namespace panwright::preview::lens_test
