// Solar cells as drawn, against the same text on the CPU and against many samples.
#include "materials/cells.h"

#include "materials/brdf.h"
#include "textured.h"

namespace panwright::preview::cells_test {
namespace {

using namespace testing_support;

materials::Material panel(double columns, double rows) {
  materials::Material material = lambert(0.1);
  material.cells = materials::Cells{.count = {columns, rows},
                                    .gap = {0.06, 0.1},
                                    .fingers = 10,
                                    .finger_width = 0.08,
                                    .gap_color = Vec3(0.7, 0.5, 0.3),
                                    .finger_color = Vec3(0.4)};
  return material;
}

// What the parts send by their shares.
Vec3 mixed(const materials::Material& material, const materials::CellShares& shares,
           const Vec3& to_sun, const Vec3& to_viewer) {
  const auto parts = materials::cell_parts(material);
  const double share[] = {shares.cell, shares.finger, shares.gap};
  Vec3 sum(0);
  for (std::size_t k = 0; k < 3; ++k)
    sum += share[k] * materials::f64::radiance(parts[k], to_sun, to_viewer, Vec3(0, 0, 1));
  return sum;
}

Vec3 pixel(const image::Image& image, std::uint32_t x, std::uint32_t y) {
  const float* p = &image.radiance[3 * (std::size_t{y} * image.width + x)];
  return {p[0], p[1], p[2]};
}

// Seen straight from above a pixel is a box, so that each one has a closed form, at every distance.
TEST(Cells, EveryPixelIsTheMeanOfItsBox) {
  for (const double width : {0.03, 0.4, 0.9}) {
    for (const double columns : {4.0, 57.0, 1200.0}) {
      const materials::Material material = panel(columns, 0.7 * columns);
      const pan::Model model = model_of(single(plate(1, 1), material));
      const View view = above(64, width);
      const image::Image image = rendered(model, view, {.samples = 1});
      double worst = 0;
      for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) {
          const Vec2 at = Vec2(x - 31.5, 31.5 - y) * (width / 64) + 0.5;
          const materials::CellShares shares =
              materials::cells_at(*material.cells, at, Vec2(width / 64));
          const Vec3 want = mixed(material, shares, Vec3(0, 0, 1), Vec3(0, 0, 1));
          const Vec3 error = glm::abs(pixel(image, x, y) - want);
          worst = std::max({worst, error.x, error.y, error.z});
        }
      // texture coordinates are known to 6e-8, of which an edge is the larger a part the smaller
      // the pixel; measured 0.8, 1.0 and 0.9 of the bound; an H100: 8.5e-4
      EXPECT_LE(worst * kPi, bound(0.6 * 1.2e-7 * 64 / width, 2e-3)) << width << ' ' << columns;
    }
  }
}

// A far panel is even: no moiré. One sample has what 256 have; what is left of the pattern falls as
// pitches per pixel rise.
TEST(Cells, FarPanelsAreEven) {
  const materials::Material material = panel(97, 61);
  const pan::Model model = model_of(single(plate(1, 1), material));
  const double covered = 0.94 * 0.9;
  const materials::CellShares mean{covered * 0.92, covered * 0.08, 1 - covered};
  const Vec3 want = mixed(material, mean, Vec3(0, 0, 1), Vec3(0, 0, 1));
  for (const auto& [width, most] : {std::pair{1.7, 0.045}, {2.9, 0.035}, {5.3, 0.015}}) {
    const View view = above(48, width);
    const image::Image image = rendered(model, view, {.samples = 1});
    const image::Image many = rendered(model, view, {.samples = 16});
    // pixels wholly on the plate
    double count = 0, sum = 0, squares = 0, points = 0, worst = 0;
    for (std::uint32_t y = 0; y < 48; ++y)
      for (std::uint32_t x = 0; x < 48; ++x) {
        const Vec2 at = glm::abs(Vec2(x - 23.5, y - 23.5)) * (width / 48);
        if (at.x > 0.5 - width / 48 || at.y > 0.5 - width / 48) continue;
        const double value = pixel(image, x, y).x;
        worst = std::max(worst, std::fabs(value - pixel(many, x, y).x));
        const Vec2 place = Vec2(x - 23.5, 23.5 - y) * (width / 48) + 0.5;
        const double point = mixed(material, materials::cells_at(*material.cells, place, Vec2(0)),
                                   Vec3(0, 0, 1), Vec3(0, 0, 1))
                                 .x;
        points += (point - want.x) * (point - want.x);
        ++count;
        sum += value;
        squares += value * value;
      }
    const double average = sum / count;
    const double spread = std::sqrt(std::max(squares / count - average * average, 0.0)) / want.x;
    // measured 1.0019, 0.0419 (0.0324, 0.0137), 1.04 to 1.29, 1.6e-5; an H100: 1.7e-3
    std::printf("mean %.5f, spread %.4f, of points %.3f, from many samples %.1e\n",
                average / want.x, spread, std::sqrt(points / count) / want.x, worst / want.x);
    EXPECT_NEAR(average / want.x, 1, 0.003) << width;
    EXPECT_LE(spread, most) << width;
    EXPECT_GT(std::sqrt(points / count) / want.x, 0.5) << width;
    EXPECT_LE(worst, bound(3e-5, 4e-3) * want.x) << width;
  }
}

// Seen askew the box stands around the footprint: edges broaden, the mean stays.
TEST(Cells, SkewedFootprintsKeepTheMean) {
  const materials::Material material = panel(12, 9);
  const pan::Model model = model_of(single(plate(1, 1), material));
  const auto sums = [&](unsigned samples) {
    View view = above(96, 1.5);
    view.world_from_model.rotation = glm::angleAxis(0.61, Vec3(0, 0, 1));
    const image::Image image = rendered(model, view, {.samples = samples});
    double sum = 0;
    for (std::size_t i = 0; i < image.radiance.size(); i += 3)
      sum += static_cast<double>(image.radiance[i]);
    return sum;
  };
  const double many = sums(16);
  // measured 0.99969
  std::printf("mean %.5f of that of many samples\n", sums(1) / many);
  EXPECT_NEAR(sums(1) / many, 1, 5e-4);
}

// Under a cover glass the gaps are without it, at any angle of the Sun.
TEST(Cells, GapsHaveNoGlass) {
  materials::Material material = panel(3, 2);
  material.coat = materials::Coat{.index = 1.5, .alpha = 0.05};
  material.specular_brdf = materials::CookTorrance{.alpha = 0.1};
  material.specular = Vec3(0.3);
  material.weights = {0, 1, 0};
  materials::fit(material);
  const pan::Model model = model_of(single(plate(1, 1), material));
  for (const double angle : {0.0, 0.4, 1.2}) {
    const Vec3 to_sun(std::sin(angle), 0, std::cos(angle));
    const View view = above(64, 0.9, to_sun);
    const image::Image image = rendered(model, view, {.samples = 1});
    double worst = 0;
    double worst_mixture = 0;
    int mixtures = 0;
    for (std::uint32_t y = 0; y < 64; ++y)
      for (std::uint32_t x = 0; x < 64; ++x) {
        const Vec2 at = Vec2(x - 31.5, 31.5 - y) * (0.9 / 64) + 0.5;
        const materials::CellShares shares =
            materials::cells_at(*material.cells, at, Vec2(0.9 / 64));
        const bool mixture = std::max({shares.cell, shares.finger, shares.gap}) < 1;
        mixtures += mixture;
        const auto parts = materials::cell_parts(material);
        const double share[] = {shares.cell, shares.finger, shares.gap};
        Vec3 want(0);
        for (std::size_t k = 0; k < 3; ++k)
          want += share[k] * materials::f64::radiance(parts[k], materials::sunlight(to_sun),
                                                      Vec3(0, 0, 1), Vec3(0, 0, 1));
        double& error = mixture ? worst_mixture : worst;
        error = std::max(error, glm::length(pixel(image, x, y) - want) / glm::length(want));
      }
    // measured 2.4e-6, and 2e-3: diffuse light goes back and forth between the glass and each part
    // by itself, what facets reflect as between it and their mean; an H100: 1.3e-3, 1.5e-2
    std::printf("%.1e, %d mixtures %.1e\n", worst, mixtures, worst_mixture);
    EXPECT_LE(worst, bound(5e-6, 4e-3)) << angle;
    EXPECT_LE(worst_mixture, bound(3e-3, 3e-2)) << angle;
    EXPECT_GT(mixtures, 1000) << angle;
  }
}

}  // namespace
}  // namespace panwright::preview::cells_test
