// Facets that are not the same all around, pixel by pixel, against the formulas in double.
#include "materials/brdf.h"
#include "textured.h"

namespace panwright::preview::brushed_test {
namespace {

using namespace testing_support;

materials::Material brushed(materials::SpecularModel brdf) {
  materials::Material material;
  material.diffuse = {0.3, 0.2, 0.1};
  material.specular = {0.9, 0.8, 0.7};
  material.weights = {0.4, 0.6, 0};
  material.specular_brdf = materials::with_slopes(brdf, {0.15, 0.4});
  materials::fit(material);
  return material;
}

// The sphere's own tangent runs around z: with u where there are texture coordinates, by
// agreement where there are none.
TEST(Brushed, SpheresAsPlaced) {
  const struct {
    Quat turn;
    Vec3 scale;
  } places[] = {{Quat(1, 0, 0, 0), Vec3(1)},
                {glm::normalize(Quat(0.3, -0.5, 0.7, 0.2)), Vec3(1)},
                {glm::normalize(Quat(0.8, 0.1, -0.5, 0.2)), Vec3(1, 0.5, 1.6)},
                {glm::normalize(Quat(0.8, 0.1, -0.5, 0.2)), Vec3(-1, 0.8, 1.1)}};
  for (const auto brdf : {materials::SpecularModel::beckmann, materials::SpecularModel::ggx})
    for (const bool texcoords : {false, true})
      for (const auto& place : places) {
        const materials::Material material = brushed(brdf);
        pan::Contents contents = single(sphere(120, 160, texcoords), material);
        contents.nodes[0].rotation = place.turn;
        contents.nodes[0].scale = place.scale;
        const pan::Model model = model_of(contents);
        View view = looking_from({1, -2, 0.6}, 1e4, 2 * std::asin(1.7 / 1e4), 160, 0.6);
        RenderOptions options;
        options.ground_truth = true;
        options.shadow_side = 0;
        const image::Image image = rendered(model, view, options);
        expect_no_nan(image);
        const materials::Material stored = pan::material_from(model.materials()[0], "");
        const Mat3 linear = glm::mat3_cast(place.turn) *
                            Mat3(place.scale.x, 0, 0, 0, place.scale.y, 0, 0, 0, place.scale.z);
        const Vec3 to_sun = glm::normalize(view.to_sun);
        double peak = 0, worst = 0, isotropic = 0;
        std::size_t pixels = 0;
        for (std::uint32_t y = 0; y < image.height; ++y)
          for (std::uint32_t x = 0; x < image.width; ++x) {
            const std::size_t pixel = std::size_t{y} * image.width + x;
            if (image.material_id[pixel] == 0) continue;
            const float* seen = &image.normal[3 * pixel];
            const Vec3 n = glm::normalize(Vec3(seen[0], seen[1], seen[2]));
            const Vec3 own = glm::normalize(glm::transpose(linear) * n);
            // where the poles are the tangent of a triangle is anybody's
            if (std::fabs(own.z) > 0.95) continue;
            ++pixels;
            Vec3 t = linear * glm::cross(Vec3(0, 0, 1), own);
            t = glm::normalize(t - n * glm::dot(n, t));
            const Vec3 to_viewer = -pixel_ray(view.camera, {x + 0.5, y + 0.5}).direction;
            const auto at = [&](const Vec3& tangent) {
              return materials::f64::radiance(stored, materials::sunlight(to_mean_sun(to_sun, n)),
                                              to_viewer, n, Vec3(1), {tangent})
                  .y;
            };
            peak = std::max(peak, at(t));
            const double drawn = static_cast<double>(image.radiance[3 * pixel + 1]);
            worst = std::max(worst, std::fabs(drawn - at(t)));
            isotropic = std::max(isotropic, std::fabs(at(Vec3(0)) - at(t)));
          }
        std::printf("BRDF %d texcoords %d: %zu pixels, worst %.1e, isotropic %.1e\n",
                    static_cast<int>(brdf), texcoords, pixels, worst / peak, isotropic / peak);
        EXPECT_GT(pixels, 3000u);
        // measured 2.4e-6 around z and 4.4e-4 along u, which runs over facets of 3 degrees;
        // an H100: 3.4e-4, 4.5e-4
        EXPECT_LE(worst / peak, texcoords ? 8e-4 : bound(5e-6, 8e-4));
        EXPECT_GE(isotropic / peak, 0.1);
      }
}

}  // namespace
}  // namespace panwright::preview::brushed_test
