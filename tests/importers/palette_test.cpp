// Images that stand for colours, against the colours that they were made of.
#include "importers/palette.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace panwright::importers::palette_test {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAre;

double decoded(int code) {  // IEC 61966-2-1
  const double c = code / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// 16 x 4 texels: blocks of 4 x 4 of one colour each, every second texel off by `noise`.
scene::Texture image_of(const std::vector<std::array<int, 3>>& colors, int noise = 0) {
  scene::Texture image;
  image.width = 4 * static_cast<std::uint32_t>(colors.size());
  image.height = 4;
  for (std::uint32_t y = 0; y < 4; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x) {
      for (const int code : colors[x / 4])
        image.rgba.push_back(static_cast<std::uint8_t>(code + ((x + y) % 2 == 0 ? noise : 0)));
      image.rgba.push_back(255);
    }
  return image;
}

// A row of unit squares, each with its texture coordinates at the middle of a block.
std::shared_ptr<geometry::Mesh> squares(const std::vector<int>& blocks, int of, double spread = 0) {
  auto mesh = std::make_shared<geometry::Mesh>();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const auto first = static_cast<std::uint32_t>(mesh->positions.size());
    for (const Vec2& corner : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) {
      mesh->positions.push_back({static_cast<double>(i) + corner.x, corner.y, 0});
      mesh->normals.push_back({0, 0, 1});
      mesh->texcoords.push_back({(blocks[i] + 0.5) / of + spread * corner.x, 0.4});
    }
    mesh->triangles.push_back({first, first + 1, first + 2});
    mesh->triangles.push_back({first, first + 2, first + 3});
  }
  return mesh;
}

Imported model_of(scene::Texture image, std::shared_ptr<const geometry::Mesh> mesh) {
  Imported out;
  out.scene.nodes.emplace_back().name = "root";
  out.scene.textures.push_back(std::move(image));
  materials::Material material;
  material.name = "Palette";
  material.diffuse = Vec3(0.5);
  material.maps.albedo = 0;
  out.scene.materials.push_back(material);
  out.materials.push_back({});
  out.materials[0].name = "Palette";
  out.materials[0].textured = true;
  out.scene.shapes.emplace_back(geometry::MeshShape(std::move(mesh)));
  out.scene.instances.emplace_back();
  return out;
}

TEST(Palette, EachColorIsAMaterial) {
  const std::vector<std::array<int, 3>> colors{
      {200, 30, 40}, {10, 20, 250}, {128, 128, 128}, {1, 2, 3}};
  for (const int noise : {0, 4}) {
    Imported model = model_of(image_of(colors, noise), squares({0, 1, 0, 2}, 4));
    model.scene.instances.push_back(model.scene.instances[0]);  // placed twice
    DiagnosticLog log;
    split_palettes(model, log);
    EXPECT_EQ(scene::check(model.scene), "");
    ASSERT_EQ(model.scene.instances.size(), 6u);
    EXPECT_EQ(model.scene.shapes.size(), 4u);  // the whole one, and three that both places share
    ASSERT_EQ(model.scene.materials.size(), 3u);
    ASSERT_EQ(model.materials.size(), 3u);
    EXPECT_THAT(to_text(log), HasSubstr("replaced 1 palette image by 3 materials"));
    for (std::size_t i = 0; i < 3; ++i) {
      const scene::Instance& one = model.scene.instances[i];
      const auto& mesh =
          *std::get<geometry::MeshShape>(model.scene.shapes[static_cast<std::size_t>(one.shape)]);
      // the colour is that of the block in which its squares stand
      const int block = mesh.positions[0].x == 3 ? 2 : mesh.positions[0].x == 1 ? 1 : 0;
      EXPECT_EQ(mesh.triangles.size(), block == 0 ? 4u : 2u);
      const materials::Material& material =
          model.scene.materials[static_cast<std::size_t>(one.material)];
      EXPECT_FALSE(material.maps.any());
      for (int k = 0; k < 3; ++k) {
        const int code = colors[static_cast<std::size_t>(block)][static_cast<std::size_t>(k)];
        // two texels of each kind around the middle: their mean
        const double linear = (decoded(code) + decoded(code + noise)) / 2;
        EXPECT_NEAR(material.diffuse[k], 0.5 * linear, 1e-12);
        EXPECT_NEAR(model.materials[static_cast<std::size_t>(one.material)].base_color[k], linear,
                    0.02 * linear + 1e-3);
      }
    }
    if (noise > 0) continue;
    std::vector<std::string> names;
    for (const CadMaterial& cad : model.materials) names.push_back(cad.name);
    EXPECT_THAT(names, UnorderedElementsAre("Palette_c81e28", "Palette_0a14fa", "Palette_808080"));
  }
}

TEST(Palette, OneColorKeepsItsMesh) {
  Imported model = model_of(image_of({{9, 9, 9}, {90, 90, 90}}), squares({1, 1}, 2));
  DiagnosticLog log;
  split_palettes(model, log);
  EXPECT_EQ(model.scene.shapes.size(), 1u);
  ASSERT_EQ(model.scene.materials.size(), 1u);
  EXPECT_EQ(model.scene.materials[0].name, "Palette_5a5a5a");
}

TEST(Palette, OtherTexturesStay) {
  const auto stays = [](Imported model, const char* what) {
    DiagnosticLog log;
    split_palettes(model, log);
    EXPECT_EQ(model.scene.instances.size(), 1u) << what;
    EXPECT_EQ(model.scene.materials[0].name, "Palette") << what;
    EXPECT_EQ(to_text(log), "") << what;
  };
  const std::vector<std::array<int, 3>> colors{{200, 30, 40}, {10, 20, 250}};
  stays(model_of(image_of(colors), squares({0, 1}, 2, 0.2)), "texels across a face");
  stays(model_of(image_of(colors, 40), squares({0, 1}, 2)), "a pattern");
  scene::Texture large = image_of(colors);
  large.width = 128, large.height = 64;
  large.rgba.resize(4 * 128 * 64, 7);
  stays(model_of(large, squares({0, 1}, 2)), "8192 texels");
  Imported bumpy = model_of(image_of(colors), squares({0, 1}, 2));
  bumpy.scene.materials[0].maps.normal = 0;
  stays(bumpy, "a normal map");
  auto lost = squares({0, 1}, 2);
  lost->texcoords[2].x = NAN;
  stays(model_of(image_of(colors), lost), "no number");
  lost->texcoords[2].x = 1e300;
  stays(model_of(image_of(colors), lost), "far out");
}

}  // namespace
}  // namespace panwright::importers::palette_test
