// Colour of the ground of a text, in images of both engines: albedo maps and materials.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "base/file_uses.h"
#include "pxn/pxn.h"
#include "tests/support/process.h"
#include "workspace/drawer.h"
#include "workspace/terrain.h"

namespace panwright::workspace::ground_colour_test {
namespace {

using testing::HasSubstr;

constexpr int kSide = 128;

// Writes an ENVI file of kSide² floats, 1 m apart about the origin.
void write_map(const support::TemporaryFolder& folder, const std::string& name,
               const std::vector<float>& values) {
  std::string data(4 * values.size(), 0);
  std::memcpy(data.data(), values.data(), data.size());
  (void)folder.write(name + ".dat", data);
  (void)folder.write(name + ".hdr",
                     "ENVI\nsamples = 128\nlines = 128\nbands = 1\ndata type = 4\nbyte order = 0\n"
                     "map info = {Local, 1, 1, -64, 64, 1, 1}\n");
}

struct Ground {
  support::TemporaryFolder folder;
  DiagnosticLog log;
  world::World world;
  bool made = false;
};

// The ground of a text of level ground and a map "albedo.hdr"; the Sun 30 degrees from the
// vertical.
std::unique_ptr<Ground> ground_of(const std::string& text, const std::vector<float>& albedo) {
  auto out = std::make_unique<Ground>();
  write_map(out->folder, "flat", std::vector<float>(kSide * kSide, 0.0f));
  write_map(out->folder, "albedo", albedo);
  (void)out->folder.write("a.ppm", std::string("P6 1 1 255\nabc"));
  std::optional<pxn::TerrainText> terrain;
  pxn::Options options;
  options.terrain = &terrain;
  const auto path =
      out->folder.write("m.pxn", "<pangu_model ver=\"1\">\n" + text + "\n</pangu_model>\n");
  if (!pxn::read(path, options, out->log) || !terrain) return out;
  const auto model = terrain_model(*terrain, out->folder.path(), out->log);
  if (!model || !out->world.add("ground", *model, out->log)) return out;
  world::Sun sun = out->world.sun();
  sun.direction = {0.5, 0, std::sqrt(0.75)};
  out->world.set_sun(sun);
  out->made = true;
  return out;
}

// 16 x 16 pixels of 4 m from above.
std::vector<float> image_of(const Ground& ground, Engine engine, std::uint32_t samples) {
  DiagnosticLog log;
  world::Camera camera;
  world::set_orthographic(camera, 16, 16, 64);
  camera.position = {0, 0, 100};
  camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), Vec3(0, 1, 0), log);
  DrawOptions options;
  options.engine = engine;
  options.samples = samples;
  Drawer drawer(options);
  const auto drawn = drawer.draw(ground.world, camera, false, log);
  EXPECT_TRUE(drawn) << to_text(log);
  // terrain needs no context, whatever the engine
  EXPECT_EQ(drawer.info().engine, engine);
  EXPECT_EQ(drawer.info().renderer, "");
  return drawn ? drawn->image.radiance : std::vector<float>();
}

// Radiance factors come back at the angles that they are of, with every material.
TEST(GroundColour, RadianceFactorsAtTheirAngles) {
  for (const std::string material : {"", R"( material="m")"}) {
    const auto m = ground_of(
        R"(<material name="m"><lambert/><diffuse> 0.3 0.3 0.3 </diffuse></material><terrain)" +
            material +
            R"(><dem file="flat.hdr" unit="m" values="height"/><albedo file="albedo.hdr" scale="0.01" reflectance="30deg 0 30deg"/></terrain>)",
        std::vector<float>(kSide * kSide, 12.0f));
    ASSERT_TRUE(m->made) << to_text(m->log);
    for (const Engine engine : {Engine::gl, Engine::reference}) {
      double mean = 0;
      const std::vector<float> radiance = image_of(*m, engine, 4);
      for (const float value : radiance) {
        // measured 1.8e-4: a pixel has sixteen places of the Sun's disc
        EXPECT_NEAR(kPi * double(value), 0.12, 3e-4);
        mean += kPi * double(value) / static_cast<double>(radiance.size());
      }
      EXPECT_NEAR(mean, 0.12, 6e-6);  // measured 2.0e-6
    }
  }
}

TEST(GroundColour, AMaterialInPlaceOfRegolith) {
  const auto m = ground_of(
      R"(<material name="m"><diffuse> 0.3 0.2 0.1 </diffuse></material><terrain material="m"><dem file="flat.hdr" unit="m" values="height"/></terrain>)",
      std::vector<float>(kSide * kSide, 1.0f));
  ASSERT_TRUE(m->made) << to_text(m->log);
  const std::vector<float> radiance = image_of(*m, Engine::gl, 4);
  ASSERT_EQ(radiance.size(), 3u * 256);
  for (std::size_t k = 0; k < radiance.size(); ++k)
    EXPECT_NEAR(double(radiance[k]), (3 - double(k % 3)) / 10 / kPi * std::sqrt(0.75),
                8e-5);  // measured 5e-5: places of the disc
}

// Pixels of 4 x 4 of the map: 2 x 2 rays, each the mean of 2 x 2 of it, against the mean of all.
TEST(GroundColour, PixelsAreMeansOfTheMap) {
  std::vector<float> values;
  for (std::uint32_t k = 0; k < kSide * kSide; ++k)
    values.push_back(static_cast<float>(0.1 + (k * 2654435761u >> 8) % 1000 / 1000.0));
  const auto m = ground_of(
      R"(<material name="m"><diffuse> 0.5 0.5 0.5 </diffuse></material><terrain material="m"><dem file="flat.hdr" unit="m" values="height"/><albedo file="albedo.hdr"/></terrain>)",
      values);
  ASSERT_TRUE(m->made) << to_text(m->log);
  EXPECT_THAT(to_text(m->log), HasSubstr("N9604"));
  double mean = 0;
  for (const float value : values) mean += double(value) / (kSide * kSide);
  const std::vector<float> drawn = image_of(*m, Engine::gl, 2);
  ASSERT_EQ(drawn.size(), 3u * 256);
  double squares = 0, sum = 0, apart = 0;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      double block = 0;
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
          block +=
              double(values[static_cast<std::size_t>((32 + 4 * y + j) * kSide + 32 + 4 * x + i)]) /
              16;
      const double wanted = 0.5 * block / mean * std::sqrt(0.75) / kPi;
      const double found = double(drawn[static_cast<std::size_t>(3 * (16 * y + x))]);
      squares += std::pow(found - wanted, 2);
      apart += std::pow(wanted - 0.5 * std::sqrt(0.75) / kPi, 2);
      sum += found / wanted / 256;
    }
  EXPECT_NEAR(sum, 1, 2e-4);                    // measured 5e-5
  EXPECT_LT(std::sqrt(squares / apart), 0.01);  // of the contrast; measured 0.0063
}

// A map that is three times its mean in places, on ground of albedo 0.5.
TEST(GroundColour, MoreLightThanThereIsIsSaid) {
  std::vector<float> values(kSide * kSide, 1.0f);
  for (std::size_t k = 0; k < values.size(); k += 8) values[k] = 4;
  const auto m = ground_of(
      R"(<material name="m"><diffuse> 0.5 0.5 0.5 </diffuse></material><terrain material="m"><dem file="flat.hdr" unit="m" values="height"/><albedo file="albedo.hdr"/></terrain>)",
      values);
  ASSERT_TRUE(m->made) << to_text(m->log);
  EXPECT_THAT(to_text(m->log), HasSubstr("reflects 1.45 times the light"));
}

// Two terrains of one run are two files.
TEST(GroundColour, TwoTextsOfOneRun) {
  DiagnosticLog log;
  log.set_files(std::make_shared<FileUses>());
  for (int k = 0; k < 3; ++k) {
    const support::TemporaryFolder folder;
    write_map(folder, "flat", std::vector<float>(kSide * kSide, 0.0f));
    pxn::TerrainText text;
    text.dems.push_back({.file = "flat.hdr", .unit = 1, .radii = false});
    EXPECT_TRUE(terrain_model(text, folder.path(), log)) << to_text(log);
  }
}

TEST(GroundColour, WhatCannotBeIsSaid) {
  const auto told = [](const std::string& albedo, const std::string& material = "") {
    return to_text(
        ground_of(
            R"(<material name="black"><diffuse> 0 0 0 </diffuse></material><material name="maps" albedo_map="a.ppm"/><terrain)" +
                material +
                R"(><dem file="flat.hdr" unit="m" values="height"/><albedo file="albedo.hdr")" +
                albedo + "/></terrain>",
            std::vector<float>(kSide * kSide, 1.0f))
            ->log);
  };
  EXPECT_THAT(told(R"( reflectance="30deg 0 20deg")"), HasSubstr("m.pxn:2:"));
  EXPECT_THAT(told(R"( reflectance="30deg 0 20deg")"), HasSubstr("there are no such angles"));
  EXPECT_THAT(told(R"( reflectance="30deg 0 30deg")", R"( material="black")"),
              HasSubstr("black at these angles"));
  EXPECT_THAT(told("", R"( material="blck")"), HasSubstr("did you mean 'black'?"));
  EXPECT_THAT(told(R"( reflectance="30deg 0 40deg")"), HasSubstr("between 30 and 30 degrees"));
  EXPECT_THAT(told(R"( reflectance="95deg 0 95deg")"), HasSubstr("below 90 degrees"));
  EXPECT_THAT(told(R"( scale="40" reflectance="30deg 0 30deg")"),
              HasSubstr("its largest radiance factor is 40"));
  EXPECT_THAT(told(R"( scale="40")"), HasSubstr("scale has no effect"));
  EXPECT_THAT(told("", R"( material="maps")"), HasSubstr("N1405"));
  EXPECT_THAT(told(R"( bands="2")"), HasSubstr("band"));
  EXPECT_THAT(told(R"( bands="1 2")"), HasSubstr("E1203"));
  EXPECT_THAT(told(R"( bands="1 1.5 2")"), HasSubstr("bands are whole numbers, found 1.5"));
}

}  // namespace
}  // namespace panwright::workspace::ground_colour_test
