// --indirect auto: mirrors that show much are drawn, those that show little are not.
#include <gtest/gtest.h>

#include "tests/support/process.h"
#include "workspace/drawer.h"
#include "workspace/open.h"

namespace panwright::workspace::mirrors_auto_test {
namespace {

// A bright block far before a small mirror, which sends little on as if diffuse.
constexpr const char* kText = R"(<pangu_model ver="1">
  <plane size="0.8 0.8" translate="0 -2.667 0" material="mirror"/>
  <box size="0.3 0.3 0.3" translate="0 0 4" material="bright"/>
  <material name="mirror"><weights>0 1 0</weights><specular>0.9 0.9 0.9</specular><mirror/></material>
  <material name="bright"><diffuse>0.8 0.8 0.8</diffuse></material>
</pangu_model>
)";

class MirrorsAuto : public testing::Test {
 protected:
  // An image of the mirrored place of the block, or of an empty one.
  std::optional<Drawn> drawn(Indirect indirect, bool seen) {
    DiagnosticLog log;
    world::World world;
    const auto model = open(folder_.write("m.pxn", kText), {}, log);
    EXPECT_TRUE(model && world.add("m", *model, log)) << to_text(log);
    world::Sun sun = world.sun();
    sun.direction = {0.2, -1, -0.3};  // from below: the mirror is dark, the block's underside lit
    world.set_sun(sun);
    world::Camera camera;
    world::set_field_of_view(camera, 96, 96, 20 * kDegree);
    camera.position = {0, -6, 5};
    const Vec3 target = seen ? Vec3(0, 0, -4) : Vec3(40, 0, 30);
    camera.world_from_camera = *world::looking_at(camera.position, target, {}, log);
    DrawOptions options;
    options.indirect = indirect;
    options.samples = 2;
    Drawer drawer(options);
    auto out = drawer.draw(world, camera, false, log);
    EXPECT_TRUE(out) << to_text(log);
    return out ? std::optional(*std::move(out)) : std::nullopt;
  }
  support::TemporaryFolder folder_;
};

TEST_F(MirrorsAuto, AreDrawnWhereTheyShowMuch) {
  const auto automatic = drawn(Indirect::automatic, true), on = drawn(Indirect::on, true);
  ASSERT_TRUE(automatic && on);
  ASSERT_TRUE(automatic->between && on->between);
  EXPECT_TRUE(automatic->between->drawn && automatic->between->mirrors);
  EXPECT_EQ(automatic->image.radiance, on->image.radiance);
  // surfels alone, measured 0.005, are below the 0.05 asked for; with mirrors 0.35 and 0.23
  EXPECT_LT(std::max(on->between->rms, on->between->flux), 0.05);
  EXPECT_GT(std::min(automatic->between->rms, automatic->between->flux), 0.15);
  const auto nothing = drawn(Indirect::automatic, false);
  ASSERT_TRUE(nothing && nothing->between);
  EXPECT_FALSE(nothing->between->drawn);
}

}  // namespace
}  // namespace panwright::workspace::mirrors_auto_test
