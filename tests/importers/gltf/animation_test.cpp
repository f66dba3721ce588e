// Nodes posed by animations: hand-made files against closed forms.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/importers/gltf/sample.h"

namespace panwright::importers::animation_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

// A sampler over node 0 of a triangle that stands 10 m along x at rest.
struct Animated {
  Sample sample = triangle();
  Animated() {
    sample.json["nodes"][0]["translation"] = {10, 0, 0};
    sample.json["animations"] = json::array();
  }
  json& add(const char* name) {
    sample.json["animations"].push_back(
        {{"name", name}, {"samplers", json::array()}, {"channels", json::array()}});
    return sample.json["animations"].back();
  }
  void channel(json& animation, const char* path, const char* interpolation, int input,
               int output) {
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", 0}, {"path", path}}}});
    animation["samplers"].push_back(
        {{"input", input}, {"output", output}, {"interpolation", interpolation}});
  }
  int times(const std::vector<float>& list) {
    const int accessor = sample.numbers(list, kFloat, "SCALAR", 1);
    sample.json["accessors"].back()["min"] = {list.front()};
    sample.json["accessors"].back()["max"] = {list.back()};
    return accessor;
  }
  int vectors(const std::vector<float>& list, int width = 3) {
    return sample.numbers(list, kFloat, width == 3 ? "VEC3" : "VEC4", width);
  }
};

Vec3 first_corner(const Loaded& out) { return corners_of(*out.imported)[0]; }

TEST(GltfAnimation, nodes_stand_at_the_first_frame_where_rest_is_elsewhere) {
  Animated file;
  json& animation = file.add("deploy");
  const int times = file.times({1, 2});
  file.channel(animation, "translation", "LINEAR", times, file.vectors({1, 2, 3, 5, 6, 7}));
  const Loaded out = load(file.sample.glb());
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_EQ(out.log.errors(), 0u) << out.text();
  EXPECT_LE(glm::length(first_corner(out) - Vec3(1, 2, 3)), 0.0);  // binary fractions
  EXPECT_TRUE(out.log.contains(Code("N6216")));
  EXPECT_THAT(out.text(), Not(HasSubstr("animation left out")));
}

TEST(GltfAnimation, of_several_on_one_property_the_first_counts) {
  Animated file;
  const int times = file.times({0, 2});
  file.channel(file.add("a"), "translation", "STEP", times, file.vectors({1, 0, 0, 2, 0, 0}));
  file.channel(file.add("b"), "translation", "STEP", times, file.vectors({3, 0, 0, 4, 0, 0}));
  const Loaded out = load(file.sample.glb());
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_EQ(first_corner(out), Vec3(1, 0, 0));
}

TEST(GltfAnimation, a_cubic_spline_starts_at_its_value_not_at_its_tangent) {
  Animated file;
  const int times = file.times({0, 2});
  file.channel(file.add("a"), "translation", "CUBICSPLINE", times,
               file.vectors({9, 9, 9, 1, 2, 3, 8, 8, 8, 7, 7, 7, 4, 5, 6, 6, 6, 6}));
  const Loaded out = load(file.sample.glb());
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_EQ(first_corner(out), Vec3(1, 2, 3));
}

TEST(GltfAnimation, normalised_integers_turn) {
  Animated file;
  const int times = file.times({0});
  // a quarter turn about z, in bytes: sin 45° as 90/127, made a unit quaternion
  const int view = file.sample.view(std::vector<std::int8_t>{0, 0, 90, 90});
  const int turns = file.sample.accessor(view, kByte, 1, "VEC4", true);
  file.channel(file.add("a"), "rotation", "LINEAR", times, turns);
  const Loaded out = load(file.sample.glb());
  ASSERT_TRUE(out.imported) << out.text();
  // the corner (1, 0, 0) goes to (0, 1, 0); measured 2.3e-16
  EXPECT_LE(glm::length(corners_of(*out.imported)[1] - Vec3(10, 1, 0)), 1e-15);
}

TEST(GltfAnimation, a_file_at_its_first_frame_is_left_and_said_as_before) {
  Animated file;
  const int times = file.times({0, 1});
  file.channel(file.add("a"), "translation", "LINEAR", times, file.vectors({10, 0, 0, 5, 6, 7}));
  const Loaded out = load(file.sample.glb());
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_EQ(first_corner(out), Vec3(10, 0, 0));
  EXPECT_FALSE(out.log.contains(Code("N6216")));
  EXPECT_THAT(out.text(), HasSubstr("1 animation that moves nothing at its first frame left out"));
}

Options at(double time, std::optional<std::string> name = {}) {
  Options options;
  options.time = time;
  options.animation = std::move(name);
  return options;
}

TEST(GltfAnimation, three_interpolations_in_closed_form) {
  for (const char* kind : {"LINEAR", "STEP"}) {
    Animated file;
    const int times = file.times({1, 3});
    file.channel(file.add("a"), "translation", kind, times, file.vectors({0, 0, 0, 4, 8, 12}));
    const Loaded out = load(file.sample.glb(), at(1.5));
    ASSERT_TRUE(out.imported) << out.text();
    EXPECT_EQ(first_corner(out), std::string(kind) == "STEP" ? Vec3(0) : Vec3(1, 2, 3));
    EXPECT_FALSE(out.log.contains(Code("N6216")));
  }
  Animated file;
  const int times = file.times({0, 2});
  // t³ on 0 to 2: values 0 and 8, slopes 0 and 12
  file.channel(file.add("a"), "translation", "CUBICSPLINE", times,
               file.vectors({0, 0, 0, 0, 0, 0, 0, 0, 0, 12, 0, 0, 8, 0, 0, 0, 0, 0}));
  for (const double t : {0.25, 0.5, 1.25}) {
    const Loaded out = load(file.sample.glb(), at(t));
    ASSERT_TRUE(out.imported) << out.text();
    // a few roundings of 8: 8 ulps of 1
    EXPECT_NEAR(first_corner(out).x, t * t * t, 2e-15);
  }
}

TEST(GltfAnimation, rotations_take_the_shorter_arc_at_even_speed) {
  Animated file;
  const int times = file.times({0, 3});
  const auto half = static_cast<float>(std::sqrt(0.5));
  // no turn to a quarter turn about z, written with the other sign
  file.channel(file.add("a"), "rotation", "LINEAR", times,
               file.vectors({0, 0, 0, 1, 0, 0, -half, -half}, 4));
  const Loaded out = load(file.sample.glb(), at(1));
  ASSERT_TRUE(out.imported) << out.text();
  const double angle = kPi / 6;  // a third of it; single precision of the keys
  EXPECT_LE(
      glm::length(corners_of(*out.imported)[1] - Vec3(10 + std::cos(angle), std::sin(angle), 0)),
      1e-7);
}

TEST(GltfAnimation, by_name_by_number_none_and_unknown) {
  Animated file;
  const int times = file.times({0, 1});
  file.channel(file.add("stow"), "translation", "LINEAR", times, file.vectors({1, 0, 0, 2, 0, 0}));
  file.channel(file.add("deploy"), "translation", "LINEAR", times,
               file.vectors({3, 0, 0, 4, 0, 0}));
  const std::string glb = file.sample.glb();
  EXPECT_EQ(first_corner(load(glb, at(1, "deploy"))), Vec3(4, 0, 0));
  EXPECT_EQ(first_corner(load(glb, at(7, "0"))), Vec3(2, 0, 0));
  EXPECT_EQ(first_corner(load(glb, at(1))), Vec3(2, 0, 0));
  EXPECT_EQ(first_corner(load(glb, at(1, "none"))), Vec3(10, 0, 0));
  const Loaded unknown = load(glb, at(1, "fold"));
  EXPECT_FALSE(unknown.imported);
  EXPECT_TRUE(unknown.log.contains(Code("E6217")));
  EXPECT_THAT(unknown.text(), HasSubstr("the file has 2 animations: 'stow', 'deploy'"));
}

TEST(GltfAnimation, samplers_that_do_not_fit_are_said_and_left_out) {
  Animated file;
  json& animation = file.add("a");
  const int times = file.times({0, 1});
  file.channel(animation, "translation", "LINEAR", times, file.vectors({1, 2, 3}));
  Loaded out = load(file.sample.glb());
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_TRUE(out.log.contains(Code("E6206"))) << out.text();
  EXPECT_EQ(first_corner(out), Vec3(10, 0, 0));

  Animated back;
  const int backwards = back.sample.numbers(std::vector<float>{1, 0}, kFloat, "SCALAR", 1);
  back.sample.json["accessors"].back()["min"] = {0};
  back.sample.json["accessors"].back()["max"] = {1};
  back.channel(back.add("a"), "translation", "LINEAR", backwards, back.vectors({1, 2, 3, 4, 5, 6}));
  out = load(back.sample.glb());
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_TRUE(out.log.contains(Code("E6206"))) << out.text();
  EXPECT_EQ(first_corner(out), Vec3(10, 0, 0));
}

}  // namespace
}  // namespace panwright::importers::animation_test
