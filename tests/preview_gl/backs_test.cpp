// Surfaces whose two sides are of different materials: what each side shows, by both engines.

#include <gtest/gtest.h>

#include "tests/preview_gl/textured.h"
#include "tests/reference/reference_models.h"

namespace panwright::preview::backs_test {
namespace {

using namespace testing_support;

materials::Material colored(const Vec3& diffuse, const char* name) {
  materials::Material material;
  material.name = name;
  material.diffuse = diffuse;
  return material;
}

const Vec3 kFrontColor(0.5, 0.25, 0.125);
const Vec3 kBackColor(0.1, 0.3, 0.7);

pan::Contents sided(const geometry::Mesh& mesh) {
  pan::Contents contents = single(mesh, colored(kFrontColor, "outer"));
  contents.materials.push_back(colored(kBackColor, "inner"));
  contents.instances[0].back = 1;
  return contents;
}

void expect_color(const Vec3& radiance, const Vec3& diffuse) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(radiance[k] * kPi, diffuse[k], 1e-6);
}

// The two from both sides by both engines: radiance and material of the middle pixel.
void expect_sides(const pan::Model& model, const Vec3& front, const Vec3& back) {
  for (const double side : {1.0, -1.0}) {
    const View view = above(16, 2, Vec3(0, 0, side), side);
    const std::uint32_t id = side > 0 ? 1 : 2;
    RenderOptions options;
    options.ground_truth = true;
    const image::Image drawn = rendered(model, view, options);
    expect_color(radiance_at(drawn, 8, 8), side > 0 ? front : back);
    EXPECT_EQ(drawn.material_id[8 * 16 + 8], id);
    EXPECT_NEAR(drawn.normal[3 * (8 * 16 + 8) + 2], side, 1e-6);
    ReferenceOptions exact = direct_light(4);
    exact.ground_truth = true;
    const image::Image truth = traced(model, view, exact).image;
    expect_color(radiance_at(truth, 8, 8), side > 0 ? front : back);
    EXPECT_EQ(truth.material_id[8 * 16 + 8], id);
  }
}

TEST(Backs, EachSideShowsItsMaterial) {
  pan::Contents contents = sided(plate(2, 2));
  expect_sides(model_of(contents), kFrontColor, kBackColor);
  // a mirror turns triangles round, and not what is outside
  for (const Vec3& mirror : {Vec3(-1, 1, 1), Vec3(1, -3, 1)}) {
    contents.nodes[0].scale = mirror;
    expect_sides(model_of(contents), kFrontColor, kBackColor);
  }
  contents.nodes[0].scale = Vec3(1, 1, -1);
  const pan::Model turned = model_of(contents);
  expect_color(radiance_at(rendered(turned, above(16, 2)), 8, 8), kBackColor);
}

// What covers the front is not on the back.
TEST(Backs, TexturesAndColorsOfVerticesAreTheFronts) {
  geometry::Mesh mesh = plate(2, 2);
  mesh.colors.assign(4, Vec3(0.5, 1, 1));
  Textured contents(sided(mesh));
  contents.instances[0].texture = contents.add(1, 1, true, [](auto, auto) { return grey(51); });
  expect_sides(model_of(contents), kFrontColor * Vec3(0.1, 0.2, 0.2), kBackColor);
  contents.materials[1].maps.albedo =
      contents.add(1, 1, true, [](auto, auto) { return grey(102); });
  expect_sides(model_of(contents), kFrontColor * Vec3(0.1, 0.2, 0.2), kBackColor * 0.4);
}

// Relief of a back's normal map stands out of the back, with u and v along the mesh's.
TEST(Backs, ReliefStandsOutOfTheBack) {
  Textured contents(sided(plate(2, 2)));
  const std::int32_t bumps = contents.add(1, 1, true, [](auto, auto) {
    return Texel{191, 128, 238, 255};
  });
  contents.materials[1].maps.normal = bumps;
  const pan::Model model = model_of(contents);
  const Vec3 to_sun = glm::normalize(Vec3(0.6, 0.2, -1));
  const View view = above(16, 2, to_sun, -1);
  const Vec3 bump = glm::normalize(Vec3(191, 128, 238) / 255.0 * 2.0 - 1.0);
  const double cosine = glm::dot(Vec3(bump.x, bump.y, -bump.z), to_sun);
  const Vec3 drawn = radiance_at(rendered(model, view), 8, 8) * kPi;
  const Vec3 truth = radiance_at(traced(model, view, direct_light(4)).image, 8, 8) * kPi;
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(drawn[k], kBackColor[k] * cosine, 2e-3 * kBackColor[k]);
    EXPECT_NEAR(truth[k], kBackColor[k] * cosine, 1e-6);
  }
}

// A decal lies on the side that it faces, over what that side is made of.
TEST(Backs, DecalsLieOnTheSideThatTheyFace) {
  Textured contents(sided(plate(2, 2)));
  contents.add(1, 1, true, [](auto, auto) { return grey(0); });
  for (const double side : {1.0, -1.0}) {
    pan::DecalContent decal;
    decal.rotation = side > 0 ? Quat(1, 0, 0, 0) : Quat(0, 1, 0, 0);
    decal.width = decal.height = 1;
    decal.depth = 0.1;
    contents.decals = {decal};
    const pan::Model model = model_of(contents);
    for (const double seen : {1.0, -1.0}) {
      const View view = above(16, 2, Vec3(0, 0, seen), seen);
      const Vec3 under = seen == side ? Vec3(0) : seen > 0 ? kFrontColor : kBackColor;
      expect_color(radiance_at(rendered(model, view), 8, 8), under);
      expect_color(radiance_at(traced(model, view, direct_light(4)).image, 8, 8), under);
    }
  }
}

double flux_off(const image::Image& drawn, const image::Image& truth) {
  double sum = 0, off = 0;
  for (std::size_t i = 0; i < drawn.radiance.size(); ++i) {
    sum += truth.radiance[i];
    off += static_cast<double>(drawn.radiance[i]) - truth.radiance[i];
  }
  return off / sum;
}

// A tube looked into at an angle, lit through its other end: outside, inside and shadow of one on
// the other, close by and far away.
TEST(Backs, AnOpenTubeAgreesWithTheReference) {
  geometry::Mesh tube;
  constexpr std::uint32_t kAround = 96;
  for (std::uint32_t i = 0; i <= kAround; ++i)
    for (const double z : {-1.0, 1.0}) {
      const double angle = 2 * kPi * i / kAround;
      tube.positions.emplace_back(std::cos(angle), std::sin(angle), z);
      tube.normals.emplace_back(std::cos(angle), std::sin(angle), 0);
      tube.texcoords.emplace_back(static_cast<double>(i) / kAround, (z + 1) / 2);
    }
  for (std::uint32_t i = 0; i < kAround; ++i) {
    const std::uint32_t a = 2 * i;
    tube.triangles.push_back({a, a + 2, a + 3});
    tube.triangles.push_back({a, a + 3, a + 1});
  }
  pan::Contents contents = sided(tube);
  const pan::Model model = model_of(contents);
  contents.instances[0].back = -1;
  const pan::Model plain = model_of(contents);
  for (const double distance : {6.0, 600.0})
    for (const double phase : {0.3, 2.2}) {
      const View view = looking_from({0.9, 0.2, 1.4}, distance, 3.4 / distance, 96, phase);
      RenderOptions options;
      options.samples = 8;
      options.ground_truth = true;
      const image::Image drawn = rendered(model, view, options);
      expect_no_nan(drawn);
      ReferenceOptions exact = direct_light(256);
      exact.ground_truth = true;
      const image::Image truth = traced(model, view, exact).image;
      const double off = flux_off(drawn, truth);
      const image::Image alike = rendered(plain, view, options);
      const double unlike = flux_off(alike, truth);
      const double as_plain = flux_off(alike, traced(plain, view, exact).image);
      printf("%g m, phase %.1f: flux %+.1e, of one material %+.1e; these two apart %+.1e\n",
             distance, phase, off, as_plain, unlike);
      EXPECT_LE(std::fabs(off), 6e-3);  // measured 3.9e-3, where shadows of rims are most of it
      EXPECT_GE(std::fabs(unlike), 5 * std::fabs(off));
      std::size_t backs = 0, wrong = 0;
      for (std::size_t i = 0; i < drawn.pixels(); ++i) {
        backs += truth.material_id[i] == 2;
        wrong += truth.material_id[i] != drawn.material_id[i];
      }
      EXPECT_GT(backs, 0u);
      EXPECT_LE(wrong, 2u);
    }
}

// Levels of detail have the same back.
TEST(Backs, LevelsHaveThemToo) {
  pan::Contents contents = sided(plate(2, 2));
  contents.meshes.push_back(contents.meshes[0]);
  contents.meshes[1].name = "coarse";
  contents.levels = {{0.001, 0.01, 0, 1, 0, 0}};
  expect_sides(model_of(contents), kFrontColor, kBackColor);
}

}  // namespace
}  // namespace panwright::preview::backs_test
