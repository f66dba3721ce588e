#include "scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace panwright::scene::scene_test {
namespace {

Scene sound_scene() {
  Scene scene;
  scene.nodes.push_back({"root", kNone, {}, {}});
  scene.nodes.push_back({"arm", 0, {{1, 0, 0}, quat_from_fixed_xyz({0, 0, kPi / 2}), Vec3(2)}, {}});
  scene.nodes.push_back({"tip", 1, {{1, 0, 0}, {1, 0, 0, 0}, Vec3(1)}, {}});
  auto mesh = std::make_shared<geometry::Mesh>();
  mesh->positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh->normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  mesh->triangles = {{0, 1, 2}};
  scene.shapes = {geometry::Sphere{}, geometry::MeshShape(mesh)};
  scene.materials.emplace_back();
  scene.textures.push_back({"t", 1, 1, {1, 2, 3, 255}, false});
  scene.instances.push_back({2, 1, 0, 0, kNone, Mapping::texcoords, Mat4(1), {}, {}});
  scene.frames.push_back({"camera", 1, Vec3(0), {1, 0, 0, 0}, {}});
  return scene;
}

TEST(WorldFromNodes, ChainsTransforms) {
  const auto world = world_from_nodes(sound_scene());
  // the tip sits 1 along the arm's x, which points to +y and is scaled by 2
  const Vec4 tip = world[2] * Vec4(0, 0, 0, 1);
  EXPECT_NEAR(tip.x, 1, 1e-15);
  EXPECT_NEAR(tip.y, 2, 1e-15);
  EXPECT_NEAR(tip.z, 0, 1e-15);
}

TEST(Check, AcceptsASoundScene) { EXPECT_EQ(check(sound_scene()), ""); }

TEST(Check, NamesEachDefect) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  auto with_mesh = [](Scene& s, const std::function<void(geometry::Mesh&)>& change) {
    auto mesh = std::make_shared<geometry::Mesh>(*std::get<geometry::MeshShape>(s.shapes[1]));
    change(*mesh);
    s.shapes[1] = geometry::MeshShape(mesh);
  };
  const std::vector<std::pair<std::string, std::function<void(Scene&)>>> defects = {
      {"no root", [](Scene& s) { s.nodes.clear(); }},
      {"parent", [](Scene& s) { s.nodes[1].parent = 2; }},
      {"parent", [](Scene& s) { s.nodes[2].parent = kNone; }},
      {"not finite", [&](Scene& s) { s.nodes[1].parent_from_node.translation.y = nan; }},
      {"not a unit quaternion", [](Scene& s) { s.nodes[1].parent_from_node.rotation.w = 2; }},
      {"scale of zero", [](Scene& s) { s.nodes[1].parent_from_node.scale.z = 0; }},
      {"radius",
       [](Scene& s) {
         s.shapes[0] = geometry::Sphere{-1, {}};
       }},
      {"too few rings",
       [](Scene& s) {
         s.shapes[0] = geometry::Sphere{1, {{1, 3}}};
       }},
      {"null mesh", [](Scene& s) { s.shapes[1] = geometry::MeshShape(); }},
      {"index 3, expected below 3",
       [&](Scene& s) { with_mesh(s, [](auto& m) { m.triangles[0][2] = 3; }); }},
      {"different length", [&](Scene& s) { with_mesh(s, [](auto& m) { m.colors.resize(2); }); }},
      {"not finite", [&](Scene& s) { with_mesh(s, [&](auto& m) { m.positions[0].x = nan; }); }},
      {"not of unit length",
       [&](Scene& s) { with_mesh(s, [](auto& m) { m.normals[0] = Vec3(0); }); }},
      {"does not exist", [](Scene& s) { s.instances[0].material = 1; }},
      {"does not exist", [](Scene& s) { s.instances[0].node = -1; }},
      {"texture 5", [](Scene& s) { s.instances[0].texture = 5; }},
      {"a back of material 7", [](Scene& s) { s.instances[0].back = 7; }},
      {"other holes on its back",
       [](Scene& s) {
         s.materials.emplace_back().maps.cutout = 0;
         s.instances[0].back = 1;
       }},
      {"texture matrix", [&](Scene& s) { s.instances[0].texture_from_shape[0][0] = nan; }},
      {"bytes", [](Scene& s) { s.textures[0].rgba.pop_back(); }},
      {"frame 0 has an unknown node", [](Scene& s) { s.frames[0].node = 9; }},
      {"duplicate frame name", [](Scene& s) { s.frames.push_back(s.frames[0]); }},
  };
  for (const auto& [words, damage] : defects) {
    Scene scene = sound_scene();
    damage(scene);
    EXPECT_THAT(check(scene), testing::HasSubstr(words));
  }
}

}  // namespace
}  // namespace panwright::scene::scene_test
