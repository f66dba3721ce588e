// Decals: where they come to lie on a mesh, and which way up.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "compiler/compile.h"
#include "compiler/internal/decals.h"
#include "pan/model.h"

namespace panwright::compiler::decals_test {
namespace {

scene::Scene scene_of(const geometry::Shape& shape) {
  scene::Scene scene;
  scene.nodes.push_back({"root", scene::kNone, {}, {}});
  scene.materials.emplace_back();
  scene.shapes = {shape};
  scene.instances.emplace_back();
  scene.textures.push_back({"flag.png", 1, 1, {1, 2, 3, 255}, false});
  scene.budget.tolerance = 1e-4;
  return scene;
}

geometry::Box box(const Vec3& size) {
  geometry::Box shape;
  shape.size = size;
  return shape;
}

scene::Decal decal_at(const Vec3& at) {
  scene::Decal decal;
  decal.name = "flag";
  decal.at = at;
  decal.width = 0.5;
  decal.height = 0.25;
  return decal;
}

pan::Model model_of(const scene::Scene& scene) {
  EXPECT_EQ(scene::check(scene), "");
  DiagnosticLog log;
  const auto bytes = compiled(scene, {}, log);
  EXPECT_TRUE(bytes) << to_text(log);
  auto model = pan::Model::from_bytes(*bytes, "decals.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return *std::move(model);
}

// The frame of the first decal: columns are right, up, outwards and the origin.
Mat4 frame_of(const scene::Scene& scene) {
  return pan::mesh_from_decal(model_of(scene).decals()[0]);
}

void expect_near(const Vec3& found, const Vec3& expected, double room) {
  EXPECT_LT(glm::length(found - expected), room)
      << found.x << ' ' << found.y << ' ' << found.z << " for " << expected.x << ' ' << expected.y
      << ' ' << expected.z;
}

constexpr double kExact = 1e-15;  // measured 3e-16

TEST(Decals, LieOnTheNearestFaceWithZUp) {
  scene::Scene scene = scene_of(box({2, 2, 2}));
  const struct {
    Vec3 at, on, outwards, up, right;
  } cases[] = {
      {{3, 0.2, 0.1}, {1, 0.2, 0.1}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
      {{-3, 0.2, 0.1}, {-1, 0.2, 0.1}, {-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
      {{0.2, -1, 0}, {0.2, -1, 0}, {0, -1, 0}, {0, 0, 1}, {1, 0, 0}},
      {{0.2, 0.1, 0.9}, {0.2, 0.1, 1}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}},
      {{0.2, 0.1, -8}, {0.2, 0.1, -1}, {0, 0, -1}, {0, 1, 0}, {-1, 0, 0}},
  };
  for (const auto& c : cases) {
    scene.decals = {decal_at(c.at)};
    const Mat4 frame = frame_of(scene);
    expect_near(Vec3(frame[3]), c.on, kExact);
    expect_near(Vec3(frame[0]), c.right, kExact);
    expect_near(Vec3(frame[1]), c.up, kExact);
    expect_near(Vec3(frame[2]), c.outwards, kExact);
  }
}

TEST(Decals, UpAsWrittenOrAsDocumented) {
  scene::Scene scene = scene_of(box({2, 2, 2}));
  scene.decals = {decal_at({2, 0, 0})};
  scene.decals[0].up = Vec3(5, 0, -7);  // leans into the face: its part along the face counts
  expect_near(Vec3(frame_of(scene)[1]), {0, 0, -1}, kExact);
  scene.decals[0].up = Vec3(1e-200, 1e-200, 0);
  expect_near(Vec3(frame_of(scene)[1]), {0, 1, 0}, kExact);
  scene.decals[0].up = Vec3(1e200, 0, 0);  // along the normal: +z
  expect_near(Vec3(frame_of(scene)[1]), {0, 0, 1}, kExact);
  scene.decals[0].at = {0, 0, 2};
  scene.decals[0].up = Vec3(1e-9, 0, -1);  // along the normal, and so is +z: +y
  expect_near(Vec3(frame_of(scene)[1]), {0, 1, 0}, kExact);
  scene.decals[0].up = Vec3(1e-5, 0, -1);  // a little off it: as written
  expect_near(Vec3(frame_of(scene)[1]), {1, 0, 0}, kExact);
}

TEST(Decals, NormalAsWritten) {
  scene::Scene scene = scene_of(box({2, 2, 2}));
  scene.decals = {decal_at({1, 0, 0})};
  scene.decals[0].normal = Vec3(3, 4, 0);
  const Mat4 frame = frame_of(scene);
  expect_near(Vec3(frame[2]), {0.6, 0.8, 0}, kExact);
  expect_near(Vec3(frame[0]), {-0.8, 0.6, 0}, kExact);
  expect_near(Vec3(frame[3]), {1, 0, 0}, kExact);
}

TEST(Decals, OnASphereWithinTheToleranceOfIt) {
  geometry::Sphere sphere;
  sphere.radius = 2;
  scene::Scene scene = scene_of(sphere);
  for (const Vec3& at : {Vec3(1, 2, 3), Vec3(-5, 0.1, 0.2), Vec3(0.1, 0.2, -0.3)}) {
    scene.decals = {decal_at(at)};
    const Mat4 frame = frame_of(scene);
    EXPECT_NEAR(glm::length(Vec3(frame[3])), 2, 1e-4);
    // the mesh's facets turn by 2·√(2·1e-4/2), and its smooth normals far less
    EXPECT_LT(angle_between(Vec3(frame[2]), at), 0.03);
    EXPECT_LT(angle_between(Vec3(frame[2]), Vec3(frame[3])), 1e-3);
  }
}

TEST(Decals, RecordsAreWhole) {
  scene::Scene scene = scene_of(box({2, 2, 2}));
  scene.nodes.push_back({"n", 0, {{7, 8, 9}, {1, 0, 0, 0}, Vec3(3)}, {}});
  scene.instances.push_back(scene.instances[0]);
  scene.instances[1].node = 1;
  scene.decals = {decal_at({1, 2, 3}), decal_at({-1, 0, 0})};
  scene.decals[0].instance = 1;
  scene.decals[1].name = "b\xe9";
  const pan::Model model = model_of(scene);
  ASSERT_EQ(model.decals().size(), 2u);
  EXPECT_EQ(model.decals()[0].instance, 1u);
  EXPECT_EQ(model.decals()[1].instance, 0u);
  EXPECT_EQ(model.decal_name(1), "b\xef\xbf\xbd");
  EXPECT_EQ(model.decals()[0].width, 0.5);
  EXPECT_EQ(model.decals()[0].height, 0.25);
  EXPECT_EQ(model.decals()[0].depth, 0.25);
  EXPECT_EQ(model.meshes().size(), 1u) << "decals ask for no mesh of their own";
}

TEST(Decals, OnWhatCannotBeMadeAreLeftOutWithIt) {
  scene::Scene scene = scene_of(box({2, 2, 2}));
  geometry::Sphere fine;
  fine.counts = {1000, 1000};
  scene.shapes.push_back(fine);
  scene.instances.insert(scene.instances.begin(), scene.instances[0]);
  scene.instances[0].shape = 1;
  scene.decals = {decal_at({1, 2, 3}), decal_at({-1, 0, 0})};
  scene.decals[1].instance = 1;
  Options options;
  options.max_triangles = 1000;
  DiagnosticLog log;
  const auto bytes = compiled(scene, options, log);
  EXPECT_EQ(log.errors(), 1u);
  DiagnosticLog reading;
  auto model = pan::Model::from_bytes(*bytes, "x", reading);
  ASSERT_TRUE(model && model->check(reading)) << to_text(reading);
  ASSERT_EQ(model->decals().size(), 1u);
  EXPECT_EQ(model->decals()[0].instance, 0u);
  EXPECT_EQ(model->instances().size(), 1u);
}

TEST(Decals, TinyHugeAndFar) {
  scene::Scene scene = scene_of(box({2e6, 2e6, 2e6}));
  scene.decals = {decal_at({1e9, 5, 5}), decal_at({1, 1, 1})};
  scene.decals[1].width = scene.decals[1].height = 5e-324;
  const pan::Model model = model_of(scene);  // checks rotations and depths
  EXPECT_NEAR(model.decals()[0].origin[0], 1e6, 1e-9);
  EXPECT_GT(model.decals()[1].depth, 0);
}

TEST(Decals, ThatShowNothingAreSaidOnce) {
  const auto complaints = [](const scene::Scene& scene) {
    DiagnosticLog log;
    EXPECT_TRUE(compiled(scene, {}, log));
    std::string out;
    for (const Diagnostic& d : log.entries())
      out += std::string(code_info(d.code).name) + " " + d.message + "\n";
    return out;
  };
  scene::Scene scene = scene_of(box({2, 2, 2}));
  scene.decals = {decal_at({0, 0, 1})};
  scene.decals[0].source = {"m.pxn", 7, 3};
  EXPECT_EQ(complaints(scene), "");
  // into the box: the top looks away, and the bottom is out of reach
  scene.decals[0].normal = Vec3(0, 0, -2);
  scene.decals.push_back(scene.decals[0]);
  EXPECT_EQ(complaints(scene),
            "W2020 m.pxn:7:3: the decal is not visible: no surface within its box faces it\n");
  scene.decals[1].source.line = 8;
  EXPECT_EQ(complaints(scene),
            "W2020 m.pxn:7:3: the decal is not visible: no surface within its box faces it\n"
            "W2020 m.pxn:8:3: the decal is not visible: no surface within its box faces it\n");
  // one that reaches through: half of 4.1 is more than the box is high
  scene.decals.resize(1);
  scene.decals[0].width = 4.1;
  EXPECT_EQ(complaints(scene), "");
  scene.decals[0].width = 3.9;
  EXPECT_NE(complaints(scene), "");
  // an open surface shows it from behind
  geometry::Plane plane;
  scene.shapes = {plane};
  EXPECT_EQ(complaints(scene), "");
  // across it, there is nothing to see
  scene.decals[0].normal = Vec3(1, 0, 0);
  EXPECT_NE(complaints(scene), "");
}

// Against points spread over triangles.
TEST(Decals, ShowWhereATriangleReachesIntoTheirBox) {
  std::mt19937 random(23);
  const auto number = [&] { return static_cast<double>(random()) * 0x1p-31 - 1; };
  const auto vector = [&] { return Vec3(number(), number(), number()); };
  int shown = 0;
  for (int i = 0; i < 3000; ++i) {
    geometry::Mesh mesh;
    const Vec3 centre = 2.0 * vector();
    const double size = i % 2 == 0 ? 3 : 0.5;
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(centre + size * vector());
    mesh.triangles = {{0, 1, 2}};
    pan::DecalContent decal;
    decal.origin = 0.3 * vector();
    decal.rotation = glm::normalize(Quat(number(), number(), number(), number()));
    decal.width = 1 + number() / 2;
    decal.height = 1 + number() / 2;
    decal.depth = 1 + number() / 2;
    // how far outside the box the nearest point is, of half its sides
    double least = HUGE_VAL;
    constexpr int kSteps = 60;
    for (int u = 0; u <= kSteps; ++u)
      for (int v = 0; u + v <= kSteps; ++v) {
        const Vec3 p = mesh.positions[0] +
                       double(u) / kSteps * (mesh.positions[1] - mesh.positions[0]) +
                       double(v) / kSteps * (mesh.positions[2] - mesh.positions[0]);
        const Vec3 q = glm::inverse(glm::mat3_cast(decal.rotation)) * (p - decal.origin) /
                       Vec3(decal.width / 2, decal.height / 2, decal.depth);
        least = std::min(least, std::max({std::fabs(q.x), std::fabs(q.y), std::fabs(q.z)}));
      }
    const bool shows = internal::shows(decal, mesh);
    shown += shows;
    if (least <= 1) {
      ASSERT_TRUE(shows) << i;
    }
    // a point is no further from one of these than 2·3·√3/60 of the least half side, 0.25
    if (shows) {
      ASSERT_LE(least, 1.7) << i;
    }
  }
  // measured: 471
  EXPECT_GT(shown, 300);
  EXPECT_LT(shown, 2500);
}

}  // namespace
}  // namespace panwright::compiler::decals_test
