// Maps of materials against closed forms and against materials without maps.
#include <cstring>

#include "materials/brdf.h"
#include "tests/reference/reference_models.h"
#include "textured.h"

namespace panwright::preview::maps_test {
namespace {

// images show glints as wide as the Sun's disc makes them
using materials::sunlight;

using namespace testing_support;

// ---- albedo

// Squares of 1 texel. The mean of the texture is the mean of the two whatever a texel spans.
TEST(AlbedoMap, MeanOfACheckerAtAnyRange) {
  for (const double repeat : {1.0, 7.0}) {
    Textured contents(single(plate(1, 1), lambert(0.9)));
    contents.materials[0].maps.albedo =
        contents.add(64, 64, true, [](auto x, auto y) { return grey((x + y) % 2 ? 230 : 20); });
    contents.materials[0].maps.repeat = Vec2(repeat);
    const pan::Model model = model_of(contents);
    const double mean = 0.9 * (230 + 20) / 2 / 255;
    for (const double texel : {10.0, 3.1, 1.0, 0.7, 0.5, 0.31, 0.1, 0.03, 0.01}) {
      // whole pixels, so that the plate's edge falls between them
      const auto size = static_cast<std::uint32_t>(std::ceil(texel * 64 * repeat));
      if (size > 1500) continue;
      for (const unsigned samples : {1u, 4u}) {
        if (size * samples > 1500) continue;
        RenderOptions options;
        options.samples = samples;
        const Sums sum = sums(rendered(model, above(size, 1), options));
        EXPECT_EQ(sum.coverage, double(size) * size);
        const double off = sum.radiance.y * kPi / sum.coverage / mean - 1;
        printf("repeat %g, %g px a texel, %u samples: %+.1e\n", repeat, texel, samples, off);
        EXPECT_LE(std::fabs(off), bound(2e-7, 3e-3));  // measured 9e-8; an H100: 1.1e-3
      }
    }
  }
}

// A texture of many parts, each in its corner: none is mixed into another at any range.
TEST(AlbedoMap, PartsOfAnAtlasKeepTheirColours) {
  constexpr double kSide = 256, kLow = 74, kWidth = 18;  // texels; not those of a mip level
  geometry::Mesh mesh = plate(1, 1);
  for (Vec2& at : mesh.texcoords) at = (kLow + kWidth * at) / kSide;
  // each facet with vertices of its own
  geometry::Mesh split;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) {
      split.positions.push_back(mesh.positions[v]);
      split.normals.push_back(mesh.normals[v]);
      split.texcoords.push_back(mesh.texcoords[v]);
    }
  split.triangles = {{0, 1, 2}, {3, 4, 5}};
  Textured contents(single(split, lambert(1)));
  const auto texture = contents.add(256, 256, true, [](auto x, auto y) {
    const auto inside = [](auto k) { return k + 1.0 >= kLow && k <= kLow + kWidth; };
    return grey(inside(x) && inside(y) ? 51 : 255);
  });
  for (const bool as_map : {false, true}) {
    contents.materials[0].maps.albedo = as_map ? texture : -1;
    contents.instances[0].texture = as_map ? -1 : texture;
    const pan::Model model = model_of(contents);
    for (const std::uint32_t size : {64u, 16u, 4u, 1u}) {
      const Sums sum = sums(rendered(model, above(size, 1), {}));
      const double off = sum.radiance.y * kPi / sum.coverage / 0.2 - 1;
      printf("%u pixels: %+.1e\n", size, off);
      EXPECT_LE(std::fabs(off), bound(2e-7, 3e-3));  // measured 6.5e-9
    }
  }
}

TEST(AlbedoMap, MultipliesTextureAndColors) {
  geometry::Mesh mesh = plate(1, 1);
  mesh.colors.assign(4, Vec3(0.5, 0.25, 1));
  Textured contents(single(mesh, lambert(0.8)));
  contents.instances[0].texture =
      contents.add(1, 1, true, [](auto, auto) { return grey(51, 0); });  // alpha is not asked
  contents.materials[0].maps.albedo =
      contents.add(2, 2, false, [](auto, auto) { return grey(100, 7); });
  const image::Image image = rendered(model_of(contents), above(4, 1));
  const double color = 0.8 * 0.2 * image::srgb_decoded(100);
  for (int k = 0; k < 3; ++k)  // measured 1.6e-7
    EXPECT_NEAR(radiance_at(image, 1, 2)[k] * kPi / (color * Vec3(0.5, 0.25, 1)[k]), 1, 5e-7);
}

// ---- roughness

// A constant map is a material with other numbers, bit for bit in software.
TEST(RoughnessMap, ConstantIsAScaledMaterial) {
  for (const int code : {0, 1, 100, 255}) {
    materials::Material material;
    material.diffuse_brdf = materials::OrenNayar{0.5};
    material.specular_brdf = materials::CookTorrance{.alpha = 0.25};
    material.diffuse = {0.8, 0.4, 0.1};
    material.specular = Vec3(1);
    material.weights = {0.6, 0.4, 0};
    material.refract = Vec3(1.5);
    Textured with(single(sphere(30, 40, true), material));
    with.materials[0].maps.roughness = with.add(4, 4, false, [&](auto, auto) {
      return Texel{std::uint8_t(code), 9, 77, 0};
    });
    pan::Contents scaled = single(sphere(30, 40, true), material);
    const double k = code / 255.0;
    scaled.materials[0].specular_brdf = materials::CookTorrance{.alpha = std::max(0.25 * k, 1e-4)};
    scaled.materials[0].diffuse_brdf = materials::OrenNayar{0.5 * k};
    const View view = looking_from({1, -2, 0.6}, 6, 0.4, 128, 0.5);
    const image::Image a = rendered(model_of(with), view);
    const image::Image b = rendered(model_of(scaled), view);
    expect_no_nan(a);
    double worst = 0;
    float peak = 0;
    for (std::size_t i = 0; i < a.radiance.size(); ++i) {
      worst = std::max(worst, double(std::fabs(a.radiance[i] - b.radiance[i])));
      peak = std::max(peak, b.radiance[i]);
    }
    printf("code %d: worst difference %.1e of peak %.2e\n", code, worst / peak, double(peak));
    // at the limb, where a normal's turn widens the lobe, its square is rounded twice; an H100:
    // 1e-7
    EXPECT_LE(worst, 3e-7 * double(peak));
  }
}

// ---- normals

Texel encoded(const Vec3& normal) {
  Texel texel{0, 0, 0, 255};
  for (int k = 0; k < 3; ++k)
    texel[static_cast<std::size_t>(k)] =
        static_cast<std::uint8_t>(std::lround((normal[k] + 1) * 127.5));
  return texel;
}
Vec3 decoded(const Texel& texel) {
  return glm::normalize(Vec3(texel[0], texel[1], texel[2]) / 127.5 - 1.0);
}

materials::Material glossy() {
  materials::Material material;
  material.specular_brdf = materials::CookTorrance{.alpha = 0.3};
  material.diffuse = Vec3(0.7);
  material.specular = Vec3(1);
  material.weights = {0.5, 0.5, 0};
  material.refract = Vec3(1.6);
  return material;
}

// A constant tilt is the tilted plate's reflectance; every way the texture can lie.
TEST(NormalMap, ConstantTiltInEveryLie) {
  const Texel texel = encoded(glm::normalize(Vec3(0.3, 0.15, 1)));
  const Vec3 tilt = decoded(texel);
  const std::array<Vec2, 4> square{Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
  const Vec3 to_sun = glm::normalize(Vec3(0.4, 0.3, 1));
  double worst = 0;
  for (int turn = 0; turn < 4; ++turn)
    for (const bool mirrored_uv : {false, true})
      for (const Vec2& repeat : {Vec2(1, 1), Vec2(-2, 1), Vec2(3, -1)})
        for (const Vec3& scale : {Vec3(1), Vec3(-1, 1, 1), Vec3(1, -1, 1), Vec3(2, 2, 2)})
          for (const double side : {1.0, -1.0}) {
            geometry::Mesh mesh = plate(1, 1);
            Vec3 along(1, 0, 0);  // where u and v grow
            Vec3 across(0, 1, 0);
            for (std::size_t i = 0; i < 4; ++i) {
              // turned counter-clockwise: corner i takes the texel of corner i − turn
              Vec2 t = square[(i + 4 - static_cast<std::size_t>(turn)) % 4];
              if (mirrored_uv) t.x = 1 - t.x;
              mesh.texcoords[i] = t;
            }
            for (int i = 0; i < turn; ++i) {
              along = Vec3(-along.y, along.x, 0);
              across = Vec3(-across.y, across.x, 0);
            }
            if (mirrored_uv) along = -along;
            Textured contents(single(mesh, glossy()));
            contents.nodes[0].scale = scale;
            contents.materials[0].maps.normal =
                contents.add(2, 2, false, [&](auto, auto) { return texel; });
            contents.materials[0].maps.repeat = repeat;
            Vec3 normal = tilt.x * along * (repeat.x < 0 ? -1.0 : 1.0) +
                          tilt.y * across * (repeat.y < 0 ? -1.0 : 1.0) + tilt.z * Vec3(0, 0, 1);
            // note: a mirrored instance is the mirror image of its bumps
            normal = glm::normalize(normal / scale);
            if (side < 0) normal = -normal;
            Vec3 sun = to_sun;
            sun.z *= side;
            RenderOptions options;
            options.flat = turn == 1;
            const image::Image image =
                rendered(model_of(contents), above(9, 1, sun, side), options);
            const Vec3 exact = materials::f64::radiance(contents.materials[0], sunlight(sun),
                                                        Vec3(0, 0, side), normal);
            worst = std::max(worst, std::fabs(radiance_at(image, 3, 5).x / exact.x - 1));
          }
  printf("worst %.1e\n", worst);
  EXPECT_LE(worst, 5e-7);  // measured 1.5e-7
}

// Bumps of a Lambert plate: near, middle, far. The mean is that of the texels' own radiances.
TEST(NormalMap, MeanOfLambertBumpsAtAnyRange) {
  Textured contents(single(plate(1, 1), lambert(0.9)));
  Vec3 mean(0);
  contents.materials[0].maps.normal = contents.add(64, 64, false, [&](auto x, auto y) {
    const Texel texel = encoded(
        glm::normalize(Vec3(0.8 * std::sin(x * 0.7 + 1.3 * y), 0.8 * std::cos(y * 1.1), 1)));
    mean += decoded(texel) / (64.0 * 64);
    return texel;
  });
  const pan::Model model = model_of(contents);
  const Vec3 to_sun = glm::normalize(Vec3(0.3, 0.2, 1));
  const double exact = 0.9 / kPi * glm::dot(mean, to_sun);
  for (const std::uint32_t size : {1024u, 640u, 200u, 64u, 50u, 20u, 3u, 1u}) {
    const Sums sum = sums(rendered(model, above(size, 1, to_sun)));
    const double off = sum.radiance.x / sum.coverage / exact - 1;
    printf("%u px: %+.1e\n", size, off);
    EXPECT_LE(std::fabs(off), 2.5e-3);  // measured 1.5e-3 at 3 texels a pixel, 1e-7 far
  }
}

// Bumps with Gaussian slopes, as the lobe's own, and a mirror lobe: widened. Reference: the mean of
// the texels' own radiances.
TEST(NormalMap, MeanOfGlossyBumpsAtAnyRange) {
  for (const double slope : {0.03, 0.1, 0.3})  // rms, of each axis
    for (const auto& [m, far] : {std::pair{0.05, 0.0}, {0.15, 0.0}, {0.15, 0.4}}) {
      Textured contents(single(plate(1, 1), glossy()));
      contents.materials[0].weights = {0, 1, 0};
      contents.materials[0].specular_brdf = materials::CookTorrance{.alpha = m};
      std::uint32_t state = 1;
      const auto deviate = [&] {
        double sum = -6;
        for (int i = 0; i < 12; ++i) {
          state = state * 1664525u + 1013904223u;
          sum += state * 0x1p-32;
        }
        return sum;
      };
      const Vec3 to_sun = glm::normalize(Vec3(far, 0.1, 1));
      double exact = 0;
      contents.materials[0].maps.normal = contents.add(128, 128, false, [&](auto, auto) {
        const double x = deviate();
        const Texel texel = encoded(glm::normalize(Vec3(slope * x, slope * deviate(), 1)));
        exact += materials::f64::radiance(contents.materials[0], sunlight(to_sun), Vec3(0, 0, 1),
                                          decoded(texel))
                     .x /
                 (128 * 128);
        return texel;
      });
      const pan::Model model = model_of(contents);
      for (const std::uint32_t size : {128u, 64u, 16u, 1u}) {
        const Sums sum = sums(rendered(model, above(size, 1, to_sun)));
        const double ratio = sum.radiance.x / sum.coverage / exact;
        printf("slopes %g, m %g, Sun %g, %u px: %+.1e\n", slope, m, far, size, ratio - 1);
        // measured 1.1e-6 at a texel a pixel, up to 0.30 where 4 unlike texels make one, whose
        // covariance is that of a sample and not of the bumps, 0.039 far; a lobe that is not
        // widened is 73 times too bright at slopes 0.3 and m 0.05
        EXPECT_NEAR(ratio, 1, size == 128 ? 3e-6 : size == 64 ? 0.35 : 0.045);
      }
    }
}

// ---- reflectance

// An aluminium-like metal in red, one that dips below F0 in green, glass in blue.
materials::Material metal(double slope) {
  materials::Material material;
  material.specular_brdf = materials::Ggx{slope, slope};
  material.diffuse = Vec3(0.3, 0.2, 0.1);
  material.specular = Vec3(1);
  material.weights = {0.2, 0.8, 0};
  material.refract = Vec3(1.37, 3.5, 1.5);
  material.extinction = Vec3(7.6, 3.3, 0);
  materials::fit(material);
  return material;
}

Vec3 reflectance_of(const Texel& texel) {
  return Vec3(image::srgb_decoded(texel[0]), image::srgb_decoded(texel[1]),
              image::srgb_decoded(texel[2]));
}

// A constant map is the BRDF with that R; what lies beside it without a map stays as it is.
TEST(ReflectanceMap, ConstantIsTheBrdf) {
  double worst = 0;
  for (const bool coated : {false, true})
    for (const bool alone : {true, false})
      for (const Texel& texel :
           {Texel{0, 0, 0, 255}, Texel{60, 188, 255, 0}, Texel{255, 240, 10, 9}}) {
        materials::Material material = metal(0.4);
        if (coated) material.coat = materials::Coat{.index = 1.4};
        materials::fit(material);
        Textured contents(single(plate(1, 1), material));
        contents.materials[0].maps.reflectance =
            contents.add(2, 2, false, [&](auto, auto) { return texel; });
        if (!alone) {
          contents.materials.push_back(material);
          contents.nodes.push_back({"aside", 0, Vec3(2, 0, 0), Quat(1, 0, 0, 0), Vec3(1)});
          contents.instances.push_back({1, 0, 1, -1});
        }
        const pan::Model model = model_of(contents);
        const materials::Material stored = pan::material_from(model.materials()[0], "");
        for (const double tilt : {0.1, 0.8, 1.4}) {
          const Vec3 to_sun(std::sin(tilt), 0, std::cos(tilt));
          const image::Image image = rendered(model, above(5, 5, to_sun));
          materials::ShadingContext local{Vec3(0), reflectance_of(texel)};
          for (const std::size_t x : {std::size_t{2}, std::size_t{4}}) {
            if (alone && x == 4) continue;
            if (x == 4) local.reflectance.reset();
            const Vec3 up(0, 0, 1);
            const Vec3 want =
                materials::f64::radiance(stored, sunlight(to_sun), up, up, Vec3(1), local);
            for (int k = 0; k < 3; ++k)
              worst = std::max(worst, std::fabs(radiance_at(image, x, 2)[k] / want[k] - 1));
          }
        }
      }
  printf("worst %.1e\n", worst);
  EXPECT_LE(worst, bound(1.5e-6, 3e-5));  // measured 6.3e-7; an H100: 9.7e-6
}

// Where F is 1, white is no map at all, bit for bit.
TEST(ReflectanceMap, WhiteOnAWhiteMirrorIsNone) {
  materials::Material material = metal(0.5);
  material.refract = {};
  material.extinction = Vec3(0);
  materials::fit(material);
  ASSERT_NE(material.fits.compensation_scale, Vec3(0));
  Textured with(single(sphere(30, 40, true), material));
  with.materials[0].maps.reflectance = with.add(4, 4, false, [](auto, auto) { return grey(255); });
  const View view = looking_from({1, -2, 0.6}, 6, 0.4, 128, 0.5);
  const image::Image a = rendered(model_of(with), view);
  const image::Image b = rendered(model_of(single(sphere(30, 40, true), material)), view);
  expect_no_nan(a);
  EXPECT_EQ(a.radiance, b.radiance);
}

// The BRDF is linear in R, so the mean texture is the BRDF of the mean, whatever a texel spans.
TEST(ReflectanceMap, MeanOfACheckerAtAnyRange) {
  const Texel dark{10, 200, 40, 255}, light{250, 90, 255, 255};
  Textured contents(single(plate(1, 1), metal(0.5)));
  contents.materials[0].compensation = materials::Compensation::off;
  materials::fit(contents.materials[0]);
  contents.materials[0].maps.reflectance =
      contents.add(64, 64, false, [&](auto x, auto y) { return (x + y) % 2 ? light : dark; });
  const pan::Model model = model_of(contents);
  const Vec3 to_sun = glm::normalize(Vec3(0.8, 0.3, 0.5)), up(0, 0, 1);
  const Vec3 mean = materials::f64::radiance(
      pan::material_from(model.materials()[0], ""), sunlight(to_sun), up, up, Vec3(1),
      {Vec3(0), 0.5 * (reflectance_of(dark) + reflectance_of(light))});
  for (const std::uint32_t size : {640u, 192u, 64u, 45u, 32u, 20u, 6u, 1u}) {
    const Sums sum = sums(rendered(model, above(size, 1, to_sun)));
    for (int k = 0; k < 3; ++k) {
      const double off = sum.radiance[k] / sum.coverage / mean[k] - 1;
      if (k == 0) printf("%u px: %+.1e\n", size, off);
      EXPECT_LE(std::fabs(off), bound(1e-6, 3e-3));  // measured 1.5e-7; an H100: 1.0e-5
    }
  }
}

// The reference reads level 0 at points, OpenGL means of texels.
TEST(ReflectanceMap, AgreesWithTheReference) {
  for (const bool round : {false, true})
    for (const bool roughened : {false, true}) {
      Textured contents(single(round ? sphere(90, 120, true) : plate(1.8, 1.8), metal(0.4)));
      contents.materials[0].maps.reflectance = contents.add(32, 16, false, [](auto x, auto y) {
        return Texel{static_cast<std::uint8_t>(60 + 6 * x), static_cast<std::uint8_t>(15 * y), 200,
                     255};
      });
      if (roughened)
        contents.materials[0].maps.roughness =
            contents.add(16, 8, true, [](auto x, auto) { return grey(120 + 8 * (x % 16)); });
      const pan::Model model = model_of(contents);
      const View view = looking_from({0.3, -0.5, 1}, 6, 0.4, 64, 0.6);
      RenderOptions options;
      options.samples = 8;
      options.shadow_side = 0;
      const image::Image drawn = rendered(model, view, options);
      const ReferenceImage exact = traced(model, view, direct_light(256));
      double square = 0, sum = 0, flux = 0, reference = 0;
      std::size_t count = 0;
      for (std::size_t i = 0; i < drawn.pixels(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          flux += drawn.radiance[3 * i + k];
          reference += exact.image.radiance[3 * i + k];
        }
        if (exact.image.coverage[i] < 1 || drawn.coverage[i] < 1) continue;
        for (std::size_t k = 0; k < 3; ++k) {
          const double off = drawn.radiance[3 * i + k] - exact.image.radiance[3 * i + k];
          square += off * off;
          sum += exact.image.radiance[3 * i + k];
          ++count;
        }
      }
      const double residual = std::sqrt(square / count) / (sum / count);
      printf("%s%s: flux %+.1e, pixels %.1e rms of the mean\n", round ? "sphere" : "plate",
             roughened ? ", roughened" : "", flux / reference - 1, residual);
      EXPECT_NEAR(flux / reference, 1, 3e-4);  // measured 1.5e-4
      EXPECT_LE(residual, 3e-3);               // measured 1.8e-3
    }
}

}  // namespace
}  // namespace panwright::preview::maps_test
