// Optics: electrons of radiance, transfer functions, images of point sources and edges.
#include "sensor/optics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <vector>

#include "sensor/psf.h"

namespace panwright::sensor::optics_test {
namespace {

// ---- radiometry

// A uniform sky: E = π L sin²θ at the centre of the image plane, and cos⁴ off the axis.
TEST(Optics, ElectronsAreThoseOfTheLensEquation) {
  Optics optics;
  optics.aperture_mm = 20;
  optics.transmission = {0.8, 0.8, 0.8};
  optics.qe = {0.5, 0.6, 0.4};
  PixelGrid grid{400, 300, Vec2(500, 500), Vec2(200, 150)};
  const Sensitivity sensitivity(optics, grid);
  const std::vector<float> radiance(3 * 400 * 300, 2.0f);
  const auto electrons = mean_electrons(radiance, sensitivity, 0.25);
  const auto at = [&](std::size_t x, std::size_t y, std::size_t band) {
    return electrons[3 * (y * 400 + x) + band];
  };
  // T A Ω L τ QE λ/(h c), written out apart: 550 nm photons have 3.6117e-19 J
  const double area = 3.14159265358979 * 0.01 * 0.01, pixel = 1.0 / (500 * 500);
  const double centre = 0.25 * area * pixel * 2 * 0.8 * 0.6 / 3.611734e-19;
  EXPECT_NEAR(at(200, 150, 1), centre, 1e-5 * centre);
  EXPECT_NEAR(at(200, 150, 0) / at(200, 150, 1), 0.5 / 0.6 * 650 / 550, 1e-5);
  for (const auto& [x, y] : {std::pair(0, 0), {399, 20}, {200, 299}}) {
    const double u = (x + 0.5 - 200) / 500, v = (y + 0.5 - 150) / 500;
    const double cosine = 1 / std::sqrt(1 + u * u + v * v);
    EXPECT_NEAR(at(x, y, 1), centre * std::pow(cosine, 4), 1e-5 * centre);
  }
  optics.vignetting = {{0, 1}, {10, 1}, {20, 0.5}};
  const Sensitivity dark(optics, grid);
  const double u = (399.5 - 200) / 500, angle = std::atan(u) * 180 / 3.14159265358979;
  EXPECT_NEAR(dark.projected()[150 * 400 + 399] / sensitivity.projected()[150 * 400 + 399],
              angle > 20 ? 0.5 : 1 - 0.05 * (angle - 10), 1e-3);
}

// Solid angles of pixels add up, whatever the lens: those of a fisheye to its cap.
TEST(Optics, PixelsOfALensCoverItsField) {
  Optics optics;
  const DistortionMap fisheye{Distortion(Fisheye{})};
  PixelGrid grid{300, 300, Vec2(100, 100), Vec2(150, 150), &fisheye};
  const Sensitivity sensitivity(optics, grid);
  // cos θ dΩ over a cap of 60 degrees is π sin² 60°
  double sum = 0;
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 300; ++x)
      if (std::hypot(x + 0.5 - 150, y + 0.5 - 150) < 100 * 3.14159265 / 3)
        sum += sensitivity.projected()[static_cast<std::size_t>(y * 300 + x)];
  EXPECT_NEAR(sum, 3.14159265 * 0.75, 0.003);
  const DistortionMap none{Distortion(Pinhole{})};
  PixelGrid plain{64, 64, Vec2(80, 80), Vec2(32, 32)}, mapped = plain;
  mapped.distortion = &none;
  const Sensitivity a(optics, plain), b(optics, mapped);
  for (std::size_t i = 0; i < a.projected().size(); ++i)
    ASSERT_NEAR(b.projected()[i] / a.projected()[i], 1, 1e-4);
}

TEST(Optics, GlareKeepsTheLightAndGhostsAreMirrored) {
  Optics optics;
  optics.veiling_glare = 0.1;
  PixelGrid grid{101, 51, Vec2(100, 100), Vec2(50.5, 25.5)};
  std::vector<float> image(3 * 101 * 51);
  image[3 * (10 * 101 + 20) + 1] = 1000;
  std::vector<float> veiled = image;
  add_glare(optics, grid, veiled);
  EXPECT_NEAR(std::accumulate(veiled.begin(), veiled.end(), 0.0), 1000, 0.01);
  EXPECT_NEAR(veiled[3 * (10 * 101 + 20) + 1], 900 + 100.0 / (101 * 51), 1e-3);
  optics.veiling_glare = 0;
  optics.ghosts = {{0.01, -1}};
  add_glare(optics, grid, image);
  EXPECT_NEAR(image[3 * (40 * 101 + 80) + 1], 10, 1e-4);  // through the centre pixel (50, 25)
  EXPECT_NEAR(std::accumulate(image.begin(), image.end(), 0.0), 1010, 1e-3);
}

// ---- transfer functions

TEST(Psf, TransferFunctionsHaveTheirValues) {
  EXPECT_NEAR(mtf_of_pixel(0.5), 0.6366, 1e-4);
  EXPECT_NEAR(mtf_of_gaussian(0.5, 0.5), 0.291, 1e-3);
  EXPECT_NEAR(mtf_of_diffraction(0.5, 1), 0.391, 1e-3);
  EXPECT_EQ(mtf_of_diffraction(0.5, 2), 0);
  constexpr double kQuarter = 1.57079632679489662;
  EXPECT_NEAR(mtf_of_defocus(1.2197, 1), 0, 1e-4);  // first zero of J1
  EXPECT_NEAR(mtf_of_defocus(0.5, 1), 2 * std::cyl_bessel_j(1, kQuarter) / kQuarter, 1e-9);
  EXPECT_NEAR(mtf_of_motion(0.25, 2), 0.6366, 1e-4);
}

// Airy: dark rings at 1.2197, 2.2331 and 3.2383 λN hold .8378, .9099 and .9376.
TEST(Psf, EncircledEnergyIsThatOfAiry) {
  Optics optics;
  optics.diffraction = true;
  EXPECT_NEAR(encircled_energy(optics, 1.7, 1.2197 * 1.7), 0.8378, 2e-4);
  EXPECT_NEAR(encircled_energy(optics, 1.7, 2.2331 * 1.7), 0.9099, 2e-4);
  EXPECT_NEAR(encircled_energy(optics, 1.7, 3.2383 * 1.7), 0.9376, 2e-4);
  EXPECT_NEAR(encircled_energy(optics, 1, 0.535), 0.5, 2e-3);
  Optics gaussian;
  gaussian.psf_px = 0.7;
  EXPECT_NEAR(encircled_energy(gaussian, 1, 1.2), 1 - std::exp(-1.2 * 1.2 / (2 * 0.49)), 1e-4);
}

// ---- images

constexpr std::uint32_t kFine = Blur::kFine;

// A point source as the renderer leaves it: the step's box and the Gaussian, then the optics.
std::vector<double> point_image(const Optics& optics, const std::array<double, 3>& airy,
                                const Vec2& place, std::uint32_t side) {
  const Blur blur(optics, airy);
  const double sigma = std::max(blur.rendered_sigma(), 1e-3);
  const std::uint32_t fine = kFine * side;
  std::vector<float> image(3 * std::size_t{fine} * fine);
  const auto share = [&](double from, double at) {
    const auto edge = [&](double x) { return 0.5 * std::erf((x - at) / (sigma * std::sqrt(2))); };
    return edge(from + 1) - edge(from);
  };
  for (std::uint32_t y = 0; y < fine; ++y)
    for (std::uint32_t x = 0; x < fine; ++x)
      for (int k = 0; k < 3; ++k)
        image[3 * (y * fine + x) + static_cast<std::size_t>(k)] =
            static_cast<float>(1000 * share(x, kFine * place.x) * share(y, kFine * place.y));
  blur.apply(image, fine, fine);
  std::vector<double> out(std::size_t{side} * side);
  for (std::uint32_t y = 0; y < fine; ++y)
    for (std::uint32_t x = 0; x < fine; ++x)
      out[y / kFine * side + x / kFine] += image[3 * (y * fine + x) + 1];
  return out;
}

// Share of a centred pixel of p = q λN: 1 → .529, 2 → .834, 3 → .872 (reference values).
TEST(Psf, APixelHoldsItsShareOfAPointSource) {
  Optics optics;
  optics.diffraction = true;
  for (const auto& [q, expected] : {std::pair(0.5, 0.177), {1.0, 0.529}, {1.5, 0.767}}) {
    const std::array<double, 3> airy{1 / q, 1 / q, 1 / q};
    const auto image = point_image(optics, airy, Vec2(30.5, 30.5), 61);
    EXPECT_NEAR(image[30 * 61 + 30] / 1000, expected, 0.002) << q;
    // what the halo spreads beyond the image
    EXPECT_NEAR(std::accumulate(image.begin(), image.end(), 0.0) / 1000, 1, 6e-3);
  }
}

// Wherever a source is, its centre and its light are right, for kernels without Gaussians too.
TEST(Psf, PointSourcesAreExactAtAnyPlace) {
  Optics airy;
  airy.diffraction = true;
  Optics all = airy;
  all.defocus_px = 1.3;
  all.psf_px = 0.3;
  for (const Optics& optics : {airy, all})
    for (const Vec2& place :
         {Vec2(20.5, 20.5), Vec2(20.1, 20.9), Vec2(20.25, 20.0), Vec2(20.77, 20.4)}) {
      const auto image = point_image(optics, {1.3, 1.1, 0.9}, place, 41);
      double sum = 0, x = 0, y = 0;
      // a window around the source: the halo of Airy's law has no second moment
      for (int j = 0; j < 41; ++j)
        for (int i = 0; i < 41; ++i) {
          const double light = image[static_cast<std::size_t>(j * 41 + i)];
          sum += light;
          x += light * (i + 0.5 - place.x);
          y += light * (j + 0.5 - place.y);
        }
      EXPECT_NEAR(sum, 1000, 8);      // less what leaves the window
      EXPECT_NEAR(x / sum, 0, 0.01);  // of the halo beyond the window, not symmetric to the source
      EXPECT_NEAR(y / sum, 0, 0.01);
      // brightest pixel by direct integration of the kernel's transform over it
      double expected = 0;
      constexpr int kSteps = 50;
      constexpr double kTop = 1.0 / 1.1;
      for (int a = -kSteps; a <= kSteps; ++a)
        for (int b = -kSteps; b <= kSteps; ++b) {
          const double u = kTop * a / kSteps, v = kTop * b / kSteps;
          const double mtf = mtf_of_optics(optics, 1.1, std::hypot(u, v));
          const double phase = 2 * 3.14159265358979 * (u * (20.5 - place.x) + v * (20.5 - place.y));
          expected += mtf * mtf_of_pixel(u) * mtf_of_pixel(v) * std::cos(phase);
        }
      expected *= 1000 * std::pow(kTop / kSteps, 2);
      EXPECT_NEAR(image[20 * 41 + 20], expected, 0.004 * 1000);
    }
}

// A measured kernel is what is convolved, with its orientation; its missing energy is spread.
TEST(Psf, MeasuredKernelsKeepTheirShapeAndEnergy) {
  Optics optics;
  optics.kernel = {3, 1, {0, 0.1, 0, 0.2, 0.4, 0.05, 0, 0.15, 0}};  // sums to 0.9
  const Blur blur(optics, {1, 1, 1}, 1);
  std::vector<float> image(3 * 41 * 41);
  image[3 * (20 * 41 + 20)] = 100;
  blur.apply(image, 41, 41);
  const double halo = 10.0 / (41 * 41);
  EXPECT_NEAR(image[3 * (20 * 41 + 20)], 40 + halo, 1e-4);
  EXPECT_NEAR(image[3 * (20 * 41 + 19)], 20 + halo, 1e-4);  // left
  EXPECT_NEAR(image[3 * (20 * 41 + 21)], 5 + halo, 1e-4);
  EXPECT_NEAR(image[3 * (19 * 41 + 20)], 10 + halo, 1e-4);  // above
  EXPECT_NEAR(image[3 * (21 * 41 + 20)], 15 + halo, 1e-4);
  EXPECT_NEAR(std::accumulate(image.begin(), image.end(), 0.0), 100, 1e-3);
}

// ---- slanted edge

// MTF of an edge of 5 degrees, as ISO 12233: bins of a quarter pixel, derivative, transform, less
// that of bin and difference.
std::vector<double> edge_mtf(const std::vector<double>& image, int side, double slope,
                             const std::vector<double>& frequencies) {
  constexpr int kBins = 4;
  const int count = kBins * side;
  std::vector<double> sum(static_cast<std::size_t>(count)), number(sum);
  const double cosine = std::cos(std::atan(slope));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double distance = (x + 0.5 - side / 2.0 - slope * (y + 0.5 - side / 2.0)) * cosine;
      const int bin = static_cast<int>(std::floor(kBins * distance)) + count / 2;
      if (bin < 0 || bin >= count) continue;
      sum[static_cast<std::size_t>(bin)] += image[static_cast<std::size_t>(y * side + x)];
      ++number[static_cast<std::size_t>(bin)];
    }
  std::vector<double> out;
  for (const double f : frequencies) {
    std::complex<double> total = 0;
    for (int k = count / 4; k + 1 < 3 * count / 4; ++k) {
      const auto a = static_cast<std::size_t>(k), b = a + 1;
      const double step = sum[b] / number[b] - sum[a] / number[a];
      total += step * std::polar(1.0, -2 * 3.14159265358979 * f * k / kBins);
    }
    // mean over a bin, and the difference of two
    out.push_back(std::abs(total) / std::pow(mtf_of_pixel(f / kBins), 2));
  }
  for (std::size_t k = out.size(); k-- > 0;) out[k] /= out[0];
  return out;
}

TEST(Psf, SlantedEdgeHasTheProductOfTransferFunctions) {
  constexpr int kSide = 96;
  const double slope = std::tan(5 * 3.14159265358979 / 180);
  Optics optics;
  optics.diffraction = true;
  optics.psf_px = 0.25;
  constexpr double kAiry = 1.2;
  const Blur blur(optics, {kAiry, kAiry, kAiry});
  const double sigma = blur.rendered_sigma();
  const int fine = kSide * static_cast<int>(kFine);
  // the edge, moved by 0.8 pixels across, as steps of the renderer see it
  constexpr double kMotion = 0.8;
  std::vector<float> image(3 * static_cast<std::size_t>(fine) * static_cast<std::size_t>(fine));
  const double cosine = std::cos(std::atan(slope));
  for (int y = 0; y < fine; ++y)
    for (int x = 0; x < fine; ++x) {
      double light = 0;
      constexpr int kParts = 6;
      for (int j = 0; j < kParts; ++j)
        for (int i = 0; i < kParts; ++i)
          for (int m = 0; m < 8; ++m) {
            const double u = x + (i + 0.5) / kParts - fine / 2.0;
            const double v = y + (j + 0.5) / kParts - fine / 2.0;
            const double moved = kFine * kMotion * ((m + 0.5) / 8 - 0.5);
            light += 0.5 * std::erfc(-((u - slope * v) * cosine - moved) / (sigma * std::sqrt(2)));
          }
      for (std::size_t k = 0; k < 3; ++k)
        image[3 * static_cast<std::size_t>(y * fine + x) + k] =
            static_cast<float>(light / (kParts * kParts * 8));
    }
  blur.apply(image, static_cast<std::uint32_t>(fine), static_cast<std::uint32_t>(fine));
  std::vector<double> pixels(kSide * kSide);
  for (int y = 0; y < fine; ++y)
    for (int x = 0; x < fine; ++x)
      pixels[static_cast<std::size_t>(y / 3 * kSide + x / 3)] +=
          image[3 * static_cast<std::size_t>(y * fine + x) + 1] / 9;
  const std::vector<double> frequencies{0, 0.1, 0.2, 0.3, 0.4, 0.5};
  const auto measured = edge_mtf(pixels, kSide, slope, frequencies);
  for (std::size_t k = 0; k < frequencies.size(); ++k) {
    const double f = frequencies[k];
    // the pixel is a square: along the edge's normal, both sides count
    const double angle = std::atan(slope);
    const double pixel = mtf_of_pixel(f * std::cos(angle)) * mtf_of_pixel(f * std::sin(angle));
    const double expected =
        pixel * mtf_of_gaussian(f, 0.25) * mtf_of_diffraction(f, kAiry) * mtf_of_motion(f, kMotion);
    EXPECT_NEAR(measured[k], expected, 0.01) << f;
  }
}

}  // namespace
}  // namespace panwright::sensor::optics_test
