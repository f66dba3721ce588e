// What the renderer says about its own error, and whether it is the same everywhere.
#include "base/parallel.h"
#include "reference_models.h"
#include "tests/support/oracles.h"

namespace panwright::preview::errors_test {
namespace {

using namespace testing_support;

// A box and a sphere beside it, in each other's light and shadow, on a few pixels.
// glossy: the box; light that bounces off it comes in rare, bright samples.
pan::Model scene_in_its_own_shadow(bool with_gloss) {
  pan::Contents contents = single(sphere(24, 24), lambert(0.7));
  contents.meshes.push_back(pan::packed(box({1, 1, 1}), "box"));
  contents.nodes.push_back({"beside", 0, Vec3(1.2, 0.4, 0.3), Quat(1, 0, 0, 0), Vec3(0.8)});
  materials::Material glossy = lambert(0.6);
  if (with_gloss) {
    glossy.specular = Vec3(0.6, 0.5, 0.4);
    glossy.weights = Vec3(0.6, 0.4, 0);
    glossy.specular_brdf = materials::CookTorrance{.alpha = 0.2};
  }
  contents.materials.push_back(glossy);
  contents.instances.push_back({1, 1, 1, -1});
  return model_of(contents);
}

View small_view() {
  View view = looking_from({0.3, -1, 0.4}, 8, 0.5, 12, 40 * kDegree);
  return view;
}

struct Bars {
  double square = 0;
  std::size_t within = 0;
  std::size_t count = 0;
  void add(double error, double sigma) {
    square += error * error / (sigma * sigma);
    within += std::fabs(error) <= 3 * sigma;
    ++count;
  }
  double rms() const { return std::sqrt(square / static_cast<double>(count)); }
  double share() const { return static_cast<double>(within) / static_cast<double>(count); }
};

TEST(ReferenceErrors, BarsAreHonest) {
  for (const bool with_gloss : {false, true}) {
    const double sigma = with_gloss ? 0.6 : 0;
    const pan::Model model = scene_in_its_own_shadow(with_gloss);
    ReferenceOptions options;
    options.psf_sigma = sigma;
    options.seed = 1'000'000;
    options.samples = 1 << 15;
    const ReferenceImage ground_truth = traced(model, small_view(), options);
    Bars flux, pixels;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
      options.seed = seed;
      options.samples = 64;
      ReferenceImage result = traced(model, small_view(), options);
      flux.add(result.flux.y - ground_truth.flux.y, result.flux_error.y);
      if (seed >= 60) continue;
      // a pixel has fewer samples to be right about than the whole image
      options.samples = 512;
      result = traced(model, small_view(), options);
      for (std::size_t i = 1; i < ground_truth.image.radiance.size(); i += 3)
        // pixels that hardly see anything have no bell-shaped errors to speak of
        if (ground_truth.image.coverage[i / 3] > 0.05)
          pixels.add(result.image.radiance[i] - ground_truth.image.radiance[i],
                     result.standard_error[i]);
    }
    printf("PSF %.1f: flux rms(error/sigma) %.3f, within 3 sigma %.4f; pixels %.3f, %.4f\n", sigma,
           flux.rms(), flux.share(), pixels.rms(), pixels.share());
    EXPECT_GE(flux.rms(), 0.7);
    EXPECT_LE(flux.rms(), 1.2);
    EXPECT_GE(flux.share(), 0.99);
    EXPECT_GE(pixels.rms(), 0.7);
    EXPECT_LE(pixels.rms(), 1.2);
    EXPECT_GE(pixels.share(), 0.99);
  }
}

// Struts thinner than a pixel before the box and the sphere: their samples often agree by chance.
pan::Model scene_with_thin_parts() {
  pan::Contents contents = single(sphere(24, 24), lambert(0.7));
  contents.meshes.push_back(pan::packed(box({1, 1, 1}), "box"));
  contents.materials.push_back(lambert(0.5));
  contents.nodes.push_back({"beside", 0, Vec3(1.2, 0.4, 0.3), Quat(1, 0, 0, 0), Vec3(0.8)});
  contents.instances.push_back({1, 1, 1, -1});
  for (std::uint32_t i = 0; i < 5; ++i) {
    const double tilt = 0.2 * i;
    contents.nodes.push_back({"strut", 0, Vec3(0.6 * i - 1.2, -1.5, 0),
                              Quat(std::cos(tilt), 0, std::sin(tilt), 0), Vec3(0.03, 0.03, 3)});
    contents.instances.push_back({i + 2, 1, 1, -1});
  }
  return model_of(contents);
}

// What is rare is in few samples, and a pixel that has missed it states an error all the same. The
// true errors, RMS over the seeds, are hardly smaller.
TEST(ReferenceErrors, PixelsThatMissedSomethingSaySo) {
  const pan::Model model = scene_with_thin_parts();
  const View view = looking_from({0.3, -1, 0.4}, 8, 28 * kDegree, 24, 40 * kDegree);
  ReferenceOptions options;
  options.seed = 1'000'000;
  options.samples = 4096;
  const ReferenceImage truth = traced(model, view, options);
  for (const std::uint32_t samples : {8u, 16u, 32u, 64u}) {
    options.samples = samples;
    constexpr std::uint64_t kSeeds = 24;
    std::vector<double> squares(truth.image.radiance.size());
    std::size_t lit = 0, within = 0;
    double stated = 0, actual = 0;
    for (options.seed = 0; options.seed < kSeeds; ++options.seed) {
      const ReferenceImage result = traced(model, view, options);
      for (std::size_t i = 0; i < squares.size(); ++i) {
        if (!(truth.image.radiance[i] > 0)) continue;
        const double error = static_cast<double>(result.image.radiance[i]) -
                             static_cast<double>(truth.image.radiance[i]);
        const double bar = result.standard_error[i];
        const double noise = truth.standard_error[i];
        ++lit;
        within += std::fabs(error) <= 3 * std::hypot(bar, noise);
        stated += bar / kSeeds;
        squares[i] += error * error / kSeeds;
      }
    }
    for (const double square : squares) actual += std::sqrt(square);
    const double share = static_cast<double>(within) / static_cast<double>(lit);
    printf("%2u samples: %.4f within 3 sigma, mean stated / true error %.2f\n", samples, share,
           stated / actual);
    EXPECT_GE(share, 0.99);
    EXPECT_LE(stated / actual, 1.5);
  }
}

// The stopping rule does not pull the answer: means over many runs agree with the truth.
TEST(ReferenceErrors, UntilErrorIsUnbiased) {
  const pan::Model model = scene_in_its_own_shadow(true);
  ReferenceOptions options;
  options.seed = 1'000'000;
  options.samples = 1 << 15;
  const ReferenceImage ground_truth = traced(model, small_view(), options);
  options.samples = 16;
  options.until_error = 4e-3;
  double sum = 0;
  Bars flux;
  constexpr int kRuns = 100;
  for (int seed = 0; seed < kRuns; ++seed) {
    options.seed = static_cast<std::uint64_t>(seed);
    const ReferenceImage result = traced(model, small_view(), options);
    EXPECT_LE(std::max({result.flux_error.x / result.flux.x, result.flux_error.y / result.flux.y,
                        result.flux_error.z / result.flux.z}),
              options.until_error);
    sum += result.flux.y / ground_truth.flux.y - 1;
    flux.add(result.flux.y - ground_truth.flux.y, result.flux_error.y);
  }
  printf("mean of %d runs: %+.1e; rms(error/sigma) %.3f\n", kRuns, sum / kRuns, flux.rms());
  EXPECT_LE(std::fabs(sum / kRuns), 4 * options.until_error / std::sqrt(kRuns));
  EXPECT_LE(flux.rms(), 1.2);
}

// A sphere whose disc covers 1 % of a pixel, wherever it lies in it, also across a corner.
TEST(ReferenceErrors, SubPixelSphere) {
  const pan::Model model = model_of(single(sphere(400, 400), lambert(0.8)));
  const double phase = 60 * kDegree;
  for (const Vec2& place : {Vec2(8.5, 8.5), Vec2(8.13, 8.81), Vec2(8, 8)}) {
    View view = looking_from({0, -1, 0}, 1e6, 1e-4, 16, phase);
    const double radius = std::sqrt(0.01 / kPi);  // pixels
    view.camera.focal = Vec2(radius * 1e6);
    view.camera.principal = place;
    ReferenceOptions options;
    options.bounces = 0;
    options.until_error = 1e-3 / 3;
    const ReferenceImage result = traced(model, view, options);
    const double exact = 0.8 * oracles::lambert_sphere_intensity(phase);
    const double off = result.flux.x * 1e12 / exact - 1;
    double coverage = 0;
    for (const float c : result.image.coverage) coverage += c;
    printf("at (%.2f, %.2f): flux %+.1e (error %.1e), covers %.6f pixels, %.2f s\n", place.x,
           place.y, off, result.flux_error.x / result.flux.x, coverage, result.seconds);
    EXPECT_LE(std::fabs(off), 1e-3);
    EXPECT_NEAR(coverage, 0.01, 2e-5);
  }
}

TEST(ReferenceErrors, SameBytesForAnyNumberOfThreads) {
  const pan::Model model = scene_in_its_own_shadow(true);
  for (const double sigma : {0.0, 0.8}) {
    std::vector<ReferenceImage> results;
    for (const std::size_t threads : {1u, 2u, 3u}) {
      ReferenceOptions options;
      options.ground_truth = true;
      options.psf_sigma = sigma;
      options.samples = 32;
      const Job job({threads, {}});
      run_on_threads(job, [&] { results.push_back(traced(model, small_view(), options)); });
      // so few cells that several units share one
      View far = small_view();
      far.camera.focal /= 200.0;
      options.until_error = 1e-2;
      run_on_threads(job, [&] { results.push_back(traced(model, far, options)); });
    }
    for (std::size_t i = 2; i < results.size(); ++i) {
      const ReferenceImage& a = results[i % 2];
      const ReferenceImage& b = results[i];
      EXPECT_EQ(a.image.radiance, b.image.radiance);
      EXPECT_EQ(a.image.coverage, b.image.coverage);
      EXPECT_EQ(a.image.depth, b.image.depth);
      EXPECT_EQ(a.image.normal, b.image.normal);
      EXPECT_EQ(a.image.node_id, b.image.node_id);
      EXPECT_EQ(a.standard_error, b.standard_error);
      EXPECT_EQ(a.flux, b.flux);
      EXPECT_EQ(a.batches, b.batches);
    }
    EXPECT_NE(results[0].image.radiance, results[1].image.radiance);
  }
}

TEST(ReferenceErrors, SeedsDiffer) {
  const pan::Model model = scene_in_its_own_shadow(true);
  ReferenceOptions options;
  const ReferenceImage first = traced(model, small_view(), options);
  options.seed = 1ull << 40;
  const ReferenceImage second = traced(model, small_view(), options);
  EXPECT_NE(first.image.radiance, second.image.radiance);
  EXPECT_NEAR(first.flux.x, second.flux.x, 5 * std::hypot(first.flux_error.x, second.flux_error.x));
}

// A blur moves light between pixels and leaves its sum; a far point becomes the Gaussian itself.
TEST(ReferenceErrors, PsfOfAPoint) {
  const pan::Model model = model_of(single(sphere(60, 60), lambert(1)));
  View view = looking_from({0, -1, 0}, 1e6, 1e-4, 16);
  view.camera.focal = Vec2(0.02 * 1e6);
  view.camera.principal = Vec2(8.3, 7.6);
  ReferenceOptions options;
  options.bounces = 0;
  options.until_error = 3e-4;
  const ReferenceImage sharp = traced(model, view, options);
  options.psf_sigma = 0.9;
  const ReferenceImage blurred = traced(model, view, options);
  // pixels of 1e-9 rad² are all of one solid angle
  EXPECT_NEAR(blurred.flux.x / sharp.flux.x, 1, 2e-3);
  const double solid_angle = pixel_solid_angle(view.camera, 8, 8);
  const auto share = [&](double pixel, double centre) {
    const double s = 0.9 * std::sqrt(2.0);
    return 0.5 * (std::erf((pixel + 1 - centre) / s) - std::erf((pixel - centre) / s));
  };
  double worst = 0;
  for (std::uint32_t j = 0; j < 16; ++j)
    for (std::uint32_t i = 0; i < 16; ++i) {
      const double exact = share(i, 8.3) * share(j, 7.6);
      const double seen = blurred.image.radiance[3 * (16 * j + i)] * solid_angle / blurred.flux.x;
      worst = std::max(worst, std::fabs(seen - exact));
    }
  printf("worst pixel of the blurred point: %.1e of its flux\n", worst);
  // the sphere is 0.02 pixels in radius, not a point: (0.02 / 0.9)² / 8 is 6e-5
  EXPECT_LE(worst, 1e-4);
}

}  // namespace
}  // namespace panwright::preview::errors_test
