#include "importers/clean.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/axis_box.h"

namespace panwright::importers::clean_test {
namespace {

using geometry::Mesh;

// Two nodes that share an unwelded cube with a face missing, and an exact sphere.
Imported sample(double size = 1) {
  Imported out;
  scene::Scene& scene = out.scene;
  scene.nodes.resize(4);
  const char* names[] = {"root", "body", "left", "right"};
  for (std::size_t i = 0; i < 4; ++i) {
    scene.nodes[i].name = names[i];
    scene.nodes[i].parent = i == 0 ? scene::kNone : i == 1 ? 0 : 1;
  }
  scene.nodes[1].parent_from_node.scale = Vec3(size);
  scene.nodes[3].parent_from_node.translation = {10, 0, 0};
  scene.materials.emplace_back();
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      if (axis == 2 && side > 0) continue;
      Vec3 right(0);
      Vec3 up(0);
      Vec3 normal(0);
      right[(axis + 1) % 3] = side;
      up[(axis + 2) % 3] = 1;
      normal[axis] = side;
      const Vec3 corners[] = {normal - right - up, normal + right - up, normal + right + up,
                              normal - right + up};
      for (const auto& t : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const int k : t) mesh.positions.push_back(corners[k]);
        mesh.triangles.push_back({first, first + 1, first + 2});
      }
    }
  }
  scene.shapes.push_back(std::make_shared<const Mesh>(std::move(mesh)));
  scene.shapes.push_back(geometry::Sphere{});
  for (const std::int32_t node : {2, 3, 1}) {
    scene::Instance instance;
    instance.node = node;
    instance.shape = node == 1 ? 1 : 0;
    scene.instances.push_back(instance);
  }
  return out;
}

const Mesh& first_mesh(const scene::Scene& scene) {
  return *std::get<geometry::MeshShape>(scene.shapes[0]);
}

TEST(CleanScene, EachMeshOnceAndExactShapesAsTheyAre) {
  Imported model = sample(2);
  DiagnosticLog log;
  const MeshReport mesh_report = *clean_up(model.scene, {}, log);
  EXPECT_EQ(scene::check(model.scene), "");
  ASSERT_EQ(mesh_report.meshes.size(), 1u);
  EXPECT_EQ(mesh_report.meshes[0].instances, 2u);
  EXPECT_EQ(mesh_report.meshes[0].path, "body/left");
  EXPECT_EQ(mesh_report.total.welded, 22u);  // 30 corners, 8 places
  EXPECT_EQ(mesh_report.total.holes,
            0u);  // its rim is 8 m long, about 20 m² of surface: rather open
  EXPECT_EQ(mesh_report.total.boundary_loops, 1u);
  EXPECT_EQ(first_mesh(model.scene).positions.size(), 20u);  // creases between five faces
  EXPECT_TRUE(std::holds_alternative<geometry::Sphere>(model.scene.shapes[1]));
  EXPECT_TRUE(log.contains(Code("N6301")));
}

TEST(CleanScene, SpotsStandInTheWorld) {
  Imported model = sample(2);
  Mesh mesh = first_mesh(model.scene);
  mesh.positions.insert(mesh.positions.end(), {{1, 1, 1}, {1, 1, -1}, {4, 4, 0}});
  mesh.triangles.push_back({30, 31, 32});
  model.scene.shapes[0] = std::make_shared<const Mesh>(mesh);
  DiagnosticLog log;
  const MeshReport mesh_report = *clean_up(model.scene, {}, log);
  ASSERT_FALSE(mesh_report.spots.empty());
  const WorldSpot& spot = mesh_report.spots[0];
  EXPECT_EQ(spot.kind, geometry::SpotKind::non_manifold_edge);
  EXPECT_EQ(spot.at, Vec3(2, 2, 0));
  EXPECT_EQ(spot.length, 4);
  EXPECT_TRUE(log.contains(Code("W6302")));
  const auto json = nlohmann::json::parse(to_json(mesh_report));
  EXPECT_EQ(json["total"]["non_manifold_edges"], 1);
  EXPECT_EQ(json["spots"][0]["kind"], "non-manifold edge");
  EXPECT_EQ(json["spots"][0]["at"], (std::vector<double>{2, 2, 0}));
  EXPECT_EQ(json["meshes"][0]["path"], "body/left");
  EXPECT_NE(to_text(mesh_report).find("1 edge of three triangles or more"), std::string::npos);
}

TEST(CleanScene, HolesAndJunctionsAreWarnedOf) {
  Imported model = sample();
  Mesh mesh = first_mesh(model.scene);
  // the lid again, but for a small triangle, and with a vertex on a side
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(
      mesh.positions.end(),
      {{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}, {0.5, -1, 1}, {0.75, -0.75, 1}});
  for (const auto& t : {std::array{0u, 4u, 5u}, std::array{1u, 2u, 5u}, std::array{2u, 3u, 5u},
                        std::array{3u, 0u, 5u}})
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  model.scene.shapes[0] = std::make_shared<const Mesh>(mesh);
  DiagnosticLog log;
  const MeshReport mesh_report = *clean_up(model.scene, {}, log);
  // the rim of the gap: two sides of it, and along the side of the cube and back
  EXPECT_EQ(mesh_report.total.t_junctions, 1u);
  EXPECT_TRUE(log.contains(Code("W6305")));
  EXPECT_EQ(mesh_report.total.holes, 1u);
  EXPECT_NEAR(mesh_report.total.hole_length, 1.5 + 2 * std::sqrt(0.125) + 2, 1e-15);
  EXPECT_TRUE(log.contains(Code("W6303")));
}

// A tolerance of the world, for a mesh that is drawn smaller than it is written.
TEST(CleanScene, TolerancesAreMetresInTheWorld) {
  for (const double tolerance : {0.9e-6, 1.1e-6}) {
    Imported model = sample(1e-3);
    Mesh mesh = first_mesh(model.scene);
    for (std::size_t v = 0; v < mesh.positions.size(); v += 2) mesh.positions[v].x += 1e-3;
    model.scene.shapes[0] = std::make_shared<const Mesh>(mesh);
    DiagnosticLog log;
    geometry::CleanOptions options;
    options.tolerance = tolerance;
    const MeshReport mesh_report = *clean_up(model.scene, options, log);
    EXPECT_EQ(mesh_report.total.largest_move > 0, tolerance > 1e-6);
    EXPECT_LE(mesh_report.total.largest_move, tolerance);
  }
}

TEST(CleanScene, MeshesWithoutTrianglesGoWithTheirDecals) {
  Imported model = sample();
  Mesh mesh;
  mesh.positions.assign(3, Vec3(1));
  mesh.triangles = {{0, 1, 2}};
  model.scene.shapes[0] = std::make_shared<const Mesh>(mesh);
  model.scene.textures.push_back({"a.png", 1, 1, {0, 0, 0, 0}, false});
  scene::Decal decal;
  decal.instance = 1;
  model.scene.decals.push_back(decal);
  decal.instance = 2;
  model.scene.decals.push_back(decal);
  DiagnosticLog log;
  ASSERT_TRUE(clean_up(model.scene, {}, log));
  ASSERT_EQ(model.scene.instances.size(), 1u);
  EXPECT_EQ(model.scene.instances[0].shape, 1);
  ASSERT_EQ(model.scene.decals.size(), 1u);
  EXPECT_EQ(model.scene.decals[0].instance, 0);
  EXPECT_EQ(scene::check(model.scene), "");
}

TEST(Place, GuessesTheUnitThatMakesASpacecraft) {
  struct Case {
    double size;
    const char* unit;
    bool plausible;
  };
  const Case cases[] = {{4, "m", true},        {0.05, "m", true},   {500, "m", true},
                        {501, "mm", true},     {3'000, "mm", true}, {109'000, "mm", true},
                        {160'000, "mm", true}, {0.004, "m", true},  {0, "m", true},
                        {1e30, "m", false},    {1e-9, "m", true}};
  for (const Case& one : cases) {
    const UnitGuess guess = guessed_unit(one.size);
    EXPECT_EQ(guess.plausible, one.plausible) << one.size;
    EXPECT_EQ(guess.name, one.unit) << one.size;
    EXPECT_EQ(*unit_of(guess.name), guess.unit);
    if (guess.plausible && one.size > 0) {
      EXPECT_GE(one.size * guess.unit, std::fmin(one.size, 0.05));
      EXPECT_LE(one.size * guess.unit, 500);
    }
  }
  EXPECT_FALSE(unit_of("furlong"));
}

TEST(Place, UnitUpAndMiddle) {
  // x from −1 to 11, y and z from −1 to 1, times 400: 4800 long, so millimetres
  Imported model = sample(400);
  model.scene.instances.pop_back();  // the sphere, whose bounds are known to a hundredth
  DiagnosticLog log;
  const AxisBox before = bounds_of(model.scene);
  EXPECT_EQ(before.low, Vec3(-400));
  EXPECT_EQ(before.high, Vec3(4400, 400, 400));
  model.scene.keypoints.push_back({"tip", 0, {100, 200, 300}, {}});
  const Vec3 moved = place(model, std::nullopt, std::nullopt, true, log);
  EXPECT_TRUE(log.contains(Code("W6006")));
  EXPECT_EQ(scene::check(model.scene), "");
  EXPECT_EQ(model.scene.nodes[0].parent_from_node, scene::Transform{});
  EXPECT_EQ(model.scene.nodes[1].name, "model");
  const AxisBox after = bounds_of(model.scene);
  // 4.4e-16 measured
  EXPECT_LT(glm::length(after.low - Vec3(-2.4, -0.4, -0.4)), 1e-14);
  EXPECT_LT(glm::length(after.high - Vec3(2.4, 0.4, 0.4)), 1e-14);
  EXPECT_LT(glm::length(moved - Vec3(-2, 0, 0)), 1e-14);
  // (x, y, z) → (x, −z, y), and what stood at the root comes along
  const scene::Keypoint& tip = model.scene.keypoints[0];
  const Mat4 world = scene::world_from_nodes(model.scene)[static_cast<std::size_t>(tip.node)];
  EXPECT_LT(glm::length(Vec3(world * Vec4(tip.position, 1)) - Vec3(0.1 - 2, -0.3, 0.2)), 1e-14);
}

TEST(Place, BoundsOfExactShapesAreGoodToAHundredth) {
  Imported model = sample();
  model.scene.instances.erase(model.scene.instances.begin(), model.scene.instances.begin() + 2);
  const AxisBox bounds = bounds_of(model.scene);
  EXPECT_LT(glm::length(bounds.low - Vec3(-1)), 0.02);
  EXPECT_LT(glm::length(bounds.high - Vec3(1)), 0.02);
}

// A box of 100 x 200 x 300 in numbers of the file, as a STEP file with a unit gives it.
Imported stated(double file_unit, Format format = Format::step) {
  Imported out;
  out.format = format;
  out.in_metres = format == Format::step;
  out.file_unit = file_unit;
  scene::Node root;
  root.name = "root";
  out.scene.nodes = {root};
  out.scene.shapes = {geometry::Box{.size = Vec3(100, 200, 300) * (out.in_metres ? file_unit : 1)}};
  out.scene.materials = {materials::Material{}};
  out.materials = {CadMaterial{}};
  out.scene.instances = {{}};
  return out;
}

TEST(Place, AGivenUnitIsWhatANumberOfTheFileMeasures) {
  const struct {
    double file;
    std::optional<double> given;
    double size;  // of the longest side, metres
    bool reported;
  } cases[] = {
      {1e-3, std::nullopt, 0.3, false}, {1e-3, 1e-3, 0.3, false},      {1e-3, 1.0, 300, true},
      {1e-3, 0.0254, 7.62, true},       {0.0254, 0.0254, 7.62, false}, {0.0254, 1e-3, 0.3, true},
      {1.0, 1.0, 300, false},           {1.0, 0.01, 3, true},
  };
  for (const auto& each : cases) {
    Imported model = stated(each.file);
    DiagnosticLog log;
    place(model, each.given, std::nullopt, false, log);
    EXPECT_NEAR(bounds_of(model.scene).longest() / each.size, 1, 1e-12);
    EXPECT_EQ(log.contains(Code("W6013")), each.reported) << to_text(log);
    EXPECT_EQ(log.entries().size(), each.reported ? 1u : 0u) << to_text(log);
  }
}

TEST(Place, AFileThatLacksItsUnitIsReportedUnlessOneIsGiven) {
  Imported model = stated(1e-3);
  model.lacks_unit = true;
  DiagnosticLog log;
  place(model, std::nullopt, std::nullopt, false, log);
  EXPECT_TRUE(log.contains(Code("W6006")));
  EXPECT_EQ(model.assumed_unit, "mm");
  EXPECT_NEAR(bounds_of(model.scene).longest(), 0.3, 1e-12);
  Imported inches = stated(1e-3);
  inches.lacks_unit = true;
  DiagnosticLog quiet;
  place(inches, 0.0254, std::nullopt, false, quiet);
  EXPECT_NEAR(bounds_of(inches.scene).longest(), 7.62, 1e-12);
  EXPECT_EQ(quiet.entries().size(), 0u) << to_text(quiet);
}

TEST(Place, SeveralUnitsOfAFileStay) {
  Imported model = stated(1e-3);
  model.file_unit = 0;
  DiagnosticLog log;
  place(model, 0.0254, std::nullopt, false, log);
  EXPECT_NEAR(bounds_of(model.scene).longest(), 0.3, 1e-12);
  EXPECT_TRUE(log.contains(Code("W6013")));
}

// Its unit is the metre: another one is right where the metre makes no sense.
TEST(Place, AUnitAgainstThatOfTheFormatIsReportedWhereMetresArePlausible) {
  for (const bool plausible : {false, true}) {
    Imported model = stated(1, Format::gltf);
    if (!plausible) model.scene.shapes = {geometry::Box{.size = {1000, 2000, 3000}}};
    DiagnosticLog log;
    place(model, 1e-3, UpAxis::z, false, log);
    EXPECT_NEAR(bounds_of(model.scene).longest(), plausible ? 0.3 : 3.0, 1e-12);
    EXPECT_EQ(log.contains(Code("W6013")), plausible) << to_text(log);
  }
}

TEST(Place, AsWrittenAddsNothing) {
  Imported model = sample();
  DiagnosticLog log;
  EXPECT_EQ(place(model, 1.0, UpAxis::z, false, log), Vec3(0));
  EXPECT_EQ(model.scene.nodes.size(), 4u);
  EXPECT_EQ(log.notes(), 0u);
  Imported far = sample(1e12);
  place(far, std::nullopt, UpAxis::z, false, log);
  EXPECT_EQ(far.scene.nodes.size(), 4u);
  EXPECT_TRUE(log.contains(Code("W6006")));
}

}  // namespace
}  // namespace panwright::importers::clean_test
