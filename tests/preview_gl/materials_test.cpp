// Every pair of BRDFs, pixel by pixel, against the double-precision reading of the formulas.
#include "materials/brdf.h"
#include "textured.h"

namespace panwright::preview::materials_test {
namespace {

using namespace testing_support;

materials::Material material_of(materials::DiffuseModel diffuse,
                                materials::SpecularModel specular) {
  materials::Material material;
  if (diffuse == materials::DiffuseModel::oren_nayar)
    material.diffuse_brdf = materials::OrenNayar{0.4};
  if (diffuse == materials::DiffuseModel::hapke)
    material.diffuse_brdf = materials::Hapke{0.33, 0.1, 0.95, 0.25};
  if (specular == materials::SpecularModel::blinn_phong)
    material.specular_brdf = materials::BlinnPhong{40};
  if (specular == materials::SpecularModel::cook_torrance)
    material.specular_brdf = materials::CookTorrance{.alpha = 0.15};
  material.diffuse = {0.8, 0.4, 0.1};
  material.specular = {0.9, 1, 0.7};
  material.emissive = {0.1, 0.02, 0.3};
  material.weights = {0.7, 0.25, 0.05};
  material.refract = Vec3(1.5, 1.7, 2.4);
  return material;
}

std::vector<materials::Material> all_pairs() {
  std::vector<materials::Material> all;
  for (const auto diffuse : {materials::DiffuseModel::lambert, materials::DiffuseModel::oren_nayar,
                             materials::DiffuseModel::hapke})
    for (const auto specular :
         {materials::SpecularModel::none, materials::SpecularModel::blinn_phong,
          materials::SpecularModel::cook_torrance})
      all.push_back(material_of(diffuse, specular));
  return all;
}

struct Comparison {
  std::size_t pixels = 0;
  double worst = 0;  // |error| over the brightest pixel's channel
};

// The radiance layer against the formulas at the ground truth layers' normals.
Comparison compared(const image::Image& image, const View& view, const pan::Model& model) {
  std::vector<materials::Material> stored;
  for (const auto& record : model.materials()) stored.push_back(pan::material_from(record, ""));
  const Vec3 to_sun = glm::normalize(view.to_sun);
  const Vec3 irradiance = view.sun_irradiance.value_or(Vec3(1));
  Comparison result;
  Vec3 peak(0);
  Vec3 worst(0);
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::size_t pixel = std::size_t{y} * image.width + x;
      if (image.material_id[pixel] == 0) continue;
      ++result.pixels;
      const float* n = &image.normal[3 * pixel];
      const Vec3 normal = glm::normalize(Vec3(n[0], n[1], n[2]));
      const Vec3 exact =
          materials::f64::radiance(stored[image.material_id[pixel] - 1],
                                   {to_mean_sun(to_sun, normal), irradiance, materials::kSunAlpha2},
                                   -pixel_ray(view.camera, {x + 0.5, y + 0.5}).direction, normal) +
          materials::f64::emission(stored[image.material_id[pixel] - 1],
                                   view.sun_irradiance ? light::kSolarIrradiance : Vec3(1));
      const float* drawn = &image.radiance[3 * pixel];
      peak = glm::max(peak, exact);
      worst = glm::max(worst, glm::abs(Vec3(drawn[0], drawn[1], drawn[2]) - exact));
    }
  for (int k = 0; k < 3; ++k) result.worst = std::max(result.worst, worst[k] / peak[k]);
  return result;
}

TEST(Materials, EveryPairOfBrdfsAloneAtAnyDistance) {
  for (const materials::Material& material : all_pairs()) {
    const pan::Model model = model_of(single(sphere(60, 80), material));
    for (const double distance : {3.0, 1e5, 1e8}) {
      View view = looking_from({1, -2, 0.6}, distance, 2 * std::asin(1.05 / distance), 160, 0.9);
      view.sun_irradiance = Vec3(1361, 900, 0.5);
      RenderOptions options;
      options.ground_truth = true;
      const image::Image image = rendered(model, view, options);
      expect_no_nan(image);
      const Comparison result = compared(image, view, model);
      EXPECT_GT(result.pixels, 15000u);
      printf("BRDF %d%d at %.0e: worst %.1e\n", static_cast<int>(material.diffuse_model()),
             static_cast<int>(material.specular_model()), distance, result.worst);
      // measured 8e-7 to 2e-5: on edges the interpolated normal is up to 1/256 pixel off; an H100:
      // 1.3e-3, everywhere
      EXPECT_LE(result.worst, bound(2e-4, 4e-3))
          << static_cast<int>(material.diffuse_model())
          << static_cast<int>(material.specular_model()) << ' ' << distance;
    }
  }
}

TEST(Materials, ManyOnOneImageKeepApart) {
  pan::Contents contents = single(sphere(40, 60), lambert(1));
  contents.materials = all_pairs();
  contents.instances.clear();
  for (std::uint32_t i = 0; i < contents.materials.size(); ++i) {
    contents.nodes.push_back(
        {"ball", 0, Vec3(2.2 * (i % 3) - 2.2, 0, 2.2 * (i / 3) - 2.2), Quat(1, 0, 0, 0), Vec3(1)});
    contents.instances.push_back({i + 1, 0, i, -1});
  }
  const pan::Model model = model_of(contents);
  const View view = looking_from({0.2, -1, 0.1}, 20, 0.4, 256, 0.7);
  RenderOptions options;
  options.ground_truth = true;
  options.shadow_side = 0;
  for (const std::uint32_t tile_side : {2048u, 50u}) {  // tiles of one material, too
    options.tile_side = tile_side;
    const image::Image image = rendered(model, view, options);
    expect_no_nan(image);
    const Comparison result = compared(image, view, model);
    printf("nine materials: %zu pixels, worst %.1e of the peak\n", result.pixels, result.worst);
    EXPECT_GT(result.pixels, 25000u);
    // measured 1.2e-4: 1/256 pixel of a ball of 38; an H100: 1.2e-2
    EXPECT_LE(result.worst, bound(5e-4, 3e-2));
  }
}

}  // namespace
}  // namespace panwright::preview::materials_test
