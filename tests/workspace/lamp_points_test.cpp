// Images of lamps: flux, place and what hides them, by both engines.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/process.h"
#include "workspace/drawer.h"
#include "workspace/lamp_text.h"
#include "workspace/open.h"
#include "world/camera.h"

namespace panwright::workspace::lamp_points_test {
namespace {

using support::TemporaryFolder;

class LampPoints : public testing::TestWithParam<Engine> {
 protected:
  LampPoints() {
    const std::string box =
        folder_.write("box.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>");
    auto model = open(box, {}, log_);
    EXPECT_TRUE(model && world_.add("box", *model, log_));
    world_.set_sun({.irradiance = Vec3(0)});
    camera_.position = {0.3, -0.2, 10};
    camera_.world_from_camera = Quat(0, 1, 0, 0);  // along -z
    world::set_field_of_view(camera_, 64, 48, 20 * kDegree);
    options_.engine = GetParam();
    options_.context = preview::ContextKind::osmesa;
    options_.samples = 2;
    options_.gl.psf_sigma = options_.reference.psf_sigma = 0.7;
  }

  image::Image drawn(const std::vector<std::string>& texts) {
    std::vector<world::Lamp> lamps;
    for (const std::string& text : texts) {
      const auto lamp = lamp_of(text, world_, log_);
      if (!lamp) break;
      lamps.push_back(*lamp);
    }
    world_.set_lamps(lamps);
    Drawer drawer(options_);
    auto image = drawer.draw(world_, camera_, false, log_);
    EXPECT_TRUE(image && lamps.size() == texts.size()) << to_text(log_);
    for (const float value : image->image.radiance) EXPECT_TRUE(std::isfinite(value));
    return std::move(image->image);
  }

  // irradiance at the camera, and its centre in the image
  struct Sum {
    double flux = 0;
    Vec2 centre{0};
  };
  Sum sum(const image::Image& image) const {
    Sum all;
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x) {
        const double part =
            static_cast<double>(image.radiance[3 * (std::size_t{y} * image.width + x)]) *
            world::pixel_solid_angle(camera_, x, y);
        all.flux += part;
        all.centre += part * Vec2(x + 0.5, y + 0.5);
      }
    all.centre /= all.flux;
    return all;
  }

  TemporaryFolder folder_;
  DiagnosticLog log_;
  world::World world_;
  world::Camera camera_;
  DrawOptions options_;
};

INSTANTIATE_TEST_SUITE_P(Engines, LampPoints, testing::Values(Engine::gl, Engine::reference),
                         [](const auto& engine) {
                           return engine.param == Engine::gl ? "gl" : "reference";
                         });

// Intensity/distance², times the cosine of a LED's axis; the centre is the projected place.
TEST_P(LampPoints, FluxAndPlace) {
  const Vec3 at(0.41, 0.13, 3);
  const Sum seen = sum(drawn({"led at 0.41 0.13 3 toward 0.41 0.13 4 intensity 2"}));
  const Vec3 to = camera_.position - at;
  const double square = glm::dot(to, to);
  const double want = 2 * to.z / std::sqrt(square) / square;
  EXPECT_NEAR(seen.flux / want, 1, 2e-6);  // floats: 2e-7
  // the camera's x is the world's, its y is turned round
  const Vec2 place = camera_.principal +
                     camera_.focal * Vec2(at.x - camera_.position.x, camera_.position.y - at.y) /
                         (camera_.position.z - at.z);
  EXPECT_LT(glm::length(seen.centre - place), 1e-3);
}

// Beyond the box, on its far side, within it, beside its silhouette, and turned away.
TEST_P(LampPoints, Hidden) {
  for (const char* place : {"0 0 -2", "0 0 0", "0.1 0.1 0.4999"})
    EXPECT_EQ(sum(drawn({std::string("led at ") + place + " intensity 1"})).flux, 0) << place;
  EXPECT_EQ(sum(drawn({"led at 2 0 3 toward 3 0 2.99 intensity 1"})).flux, 0);
  // the silhouette of the near face, half a millimetre inside and outside of it: at z = -2 rays
  // through x = 0.5 at z = 0.5 are at 0.3 + 0.2·12/9.5
  const double edge = 0.3 + 0.2 * 12 / 9.5;
  const auto beside = [&](double x) {
    return sum(drawn({fmt::format("led at {} 0 -2 intensity 1", x)})).flux;
  };
  EXPECT_EQ(beside(edge - 5e-4), 0);
  EXPECT_GT(beside(edge + 5e-4), 0.006);
}

// On a housing; with a size: a sphere sends intensity/distance², whatever its size in the image.
TEST_P(LampPoints, OnAHousingAndOfASize) {
  const double square = 0.3 * 0.3 + 0.2 * 0.2 + 9.5 * 9.5;
  EXPECT_NEAR(sum(drawn({"led at 0 0 0.5 intensity 1"})).flux, 9.5 / std::sqrt(square) / square,
              1e-7);
  for (const char* radius : {"1mm", "0.02", "0.3"}) {
    const Sum seen = sum(
        drawn({std::string("spot at 0.3 -0.2 4 half-angle 89deg intensity 1 radius ") + radius}));
    EXPECT_NEAR(seen.flux * 36, 1, 1e-5) << radius;
    EXPECT_LT(glm::length(seen.centre - camera_.principal), 0.02) << radius;
  }
}

// Finite at the pinhole and next to it; an orthographic camera sees none.
TEST_P(LampPoints, AtThePinhole) {
  for (const char* text :
       {"point on camera intensity 1", "point on camera at 0 0 1e-9 intensity 1e6",
        "point on camera at 0 0 0.1 radius 0.2 intensity 1", "led on camera intensity 1",
        "point at 0 0 1e9 intensity 1e30", "point on camera at 0 0 1e20 intensity 1e30"})
    drawn({text});
  camera_.projection = world::Projection::orthographic;
  for (const float value : drawn({"led at 0 0 3 intensity 1"}).radiance) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace panwright::workspace::lamp_points_test
