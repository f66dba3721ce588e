#include "compiler/compile.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "base/file.h"
#include "base/parallel.h"
#include "geometry/tessellate/tessellate.h"
#include "pan/model.h"

namespace panwright::compiler::compile_test {
namespace {

geometry::MeshShape plate(double offset) {
  auto mesh = std::make_shared<geometry::Mesh>();
  mesh->positions = {{offset, 0, 0}, {offset + 1, 0, 0}, {offset + 1, 2, 0}, {offset, 2, 0}};
  mesh->normals.assign(4, {0, 0, 1});
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

scene::Instance at(std::int32_t node, std::int32_t shape) {
  scene::Instance instance;
  instance.node = node;
  instance.shape = shape;
  instance.source = {"model.pxn", 3, 7};
  return instance;
}

// A root with `count` children, 3 m apart.
scene::Scene scene_with_nodes(int count) {
  scene::Scene scene;
  scene.nodes.push_back({"root", scene::kNone, {}, {}});
  for (int i = 0; i < count; ++i)
    scene.nodes.push_back(
        {"n" + std::to_string(i), 0, {Vec3(3 * i, 0, 0), {1, 0, 0, 0}, Vec3(1)}, {}});
  scene.materials.emplace_back();
  return scene;
}

pan::Model load(const scene::Scene& scene, const Options& options = {}) {
  EXPECT_EQ(scene::check(scene), "");
  DiagnosticLog log;
  const auto bytes = compiled(scene, options, log);
  EXPECT_TRUE(bytes) << to_text(log);
  auto model = pan::Model::from_bytes(*bytes, "test.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return std::move(*model);
}

// What readers of a pan refuse is an error at the element.
TEST(Compile, NumbersOutOfRangeAreErrorsAtTheirElements) {
  const auto problem = [](const scene::Scene& scene) {
    EXPECT_EQ(scene::check(scene), "");
    DiagnosticLog log;
    const auto bytes = compiled(scene, {}, log);
    if (bytes) {
      auto model = pan::Model::from_bytes(*bytes, "test.pan", log);
      EXPECT_TRUE(model && model->check(log)) << to_text(log);
    }
    EXPECT_EQ(exit_code(log), 1);
    for (const Diagnostic& each : log.entries())
      if (each.severity() == Severity::error)
        return std::string(code_info(each.code).name) + " " + each.message;
    return std::string();
  };
  for (const geometry::Shape& shape :
       {geometry::Shape(geometry::Dish{1, 2, 1e-30}),
        geometry::Shape(geometry::Dish{2, 1e-29, 0.1, {500, 100}})}) {
    scene::Scene thin = scene_with_nodes(1);
    thin.shapes = {shape};
    thin.instances = {at(1, 0)};
    EXPECT_EQ(problem(thin).substr(0, 23), "E2011 model.pxn:3:7: pa");
  }
  // 1e9 to the 40th
  scene::Scene chain = scene_with_nodes(41);
  for (std::int32_t i = 1; i <= 41; ++i) {
    chain.nodes[static_cast<std::size_t>(i)].source = {"model.pxn", static_cast<unsigned>(i), 1};
    scene::Joint joint;
    joint.node = i;
    joint.kind = scene::JointKind::prismatic;
    if (i == 1) joint.value = {1};
    if (i > 1) joint.mimic = i - 2;
    joint.multiplier = 1e9;
    chain.joints.push_back(joint);
  }
  chain.shapes = {geometry::Box{Vec3(1)}};
  chain.instances = {at(1, 0)};
  EXPECT_EQ(problem(chain).substr(0, 38), "E2010 model.pxn:24:1: node 'n23' lies ");
}

TEST(Compile, EqualShapesAreStoredOnce) {
  scene::Scene scene = scene_with_nodes(4);
  scene.shapes = {geometry::Sphere{1, {{20, 30}}}, plate(0), geometry::Sphere{1, {{20, 30}}},
                  plate(0), plate(1)};
  for (std::int32_t i = 0; i < 5; ++i) scene.instances.push_back(at(i % 4 + 1, i));
  const pan::Model model = load(scene);
  EXPECT_EQ(model.meshes().size(), 3u);
  EXPECT_EQ(model.instances().size(), 5u);
  EXPECT_EQ(model.instances()[0].mesh, model.instances()[2].mesh);
  EXPECT_EQ(model.instances()[1].mesh, model.instances()[3].mesh);
  EXPECT_NE(model.instances()[1].mesh, model.instances()[4].mesh);
  EXPECT_EQ(model.meshes()[0].triangle_count, 2u * 30 * 19);
}

// Statistics stand beside the mesh that came from the sheet, wherever that is among them; one that
// no instance shows has none.
TEST(Compile, SheetsStandBesideTheirMeshes) {
  scene::Scene scene = scene_with_nodes(3);
  scene.shapes = {geometry::Sphere{1, {{20, 30}}}, plate(0), plate(1), plate(2)};
  for (const std::int32_t shape : {0, 3, 1}) scene.instances.push_back(at(shape % 3 + 1, shape));
  for (const std::int32_t shape : {1, 2, 3}) {
    scene::Foil foil;
    foil.shape = shape;
    foil.recipe.width = 2;
    foil.recipe.height = 1;
    foil.recipe.xgrid = 10;
    foil.recipe.seed = static_cast<std::uint32_t>(100 + shape);
    foil.form = mli::Cone{};
    foil.statistics.slope_covariance = {1, 2, 3};
    foil.statistics.facet_slope_covariance = {4, 5, 6};
    foil.statistics.slope_mean = {7, 8};
    foil.statistics.correlation_length = {9, 10};
    foil.statistics.slope_rms = 11;
    foil.statistics.height_rms = 12;
    foil.statistics.height_mean = 13;
    foil.statistics.lowest = -14;
    foil.statistics.highest = 15;
    scene.foils.push_back(foil);
  }
  const pan::Model model = load(scene);
  ASSERT_EQ(model.sheets().size(), 2u);
  for (const pan::layout::Sheet& sheet : model.sheets()) {
    const std::uint32_t shape = sheet.seed - 100;
    // plates begin at 0, 1, 2 and are 1 wide
    EXPECT_EQ(model.meshes()[sheet.mesh].origin[0], shape - 1 + 0.5);
    EXPECT_EQ(sheet.columns, 10u);
    EXPECT_EQ(sheet.rows, 5u);
    EXPECT_EQ(sheet.form, 2u);
    const double numbers[] = {sheet.slope_covariance[0],
                              sheet.slope_covariance[1],
                              sheet.slope_covariance[2],
                              sheet.facet_slope_covariance[0],
                              sheet.facet_slope_covariance[1],
                              sheet.facet_slope_covariance[2],
                              sheet.slope_mean[0],
                              sheet.slope_mean[1],
                              sheet.correlation_length[0],
                              sheet.correlation_length[1],
                              sheet.slope_rms,
                              sheet.height_rms,
                              sheet.height_mean,
                              -sheet.lowest,
                              sheet.highest};
    for (std::size_t i = 0; i < std::size(numbers); ++i)
      EXPECT_EQ(numbers[i], static_cast<double>(i + 1));
  }
  // a model without has no such section: its bytes are as ever
  scene.foils.clear();
  const pan::Model bare = load(scene);
  EXPECT_TRUE(bare.sheets().empty());
  EXPECT_EQ(bare.directory().size() + 1, model.directory().size());
}

// A sheet of cells of 10 mm with levels of 20 and 40 mm, as plates that begin at their numbers.
scene::Scene leveled_scene(int instances) {
  scene::Scene scene = scene_with_nodes(instances + 1);
  scene.shapes = {plate(0)};
  scene::Foil foil;
  foil.shape = 0;
  foil.recipe.width = foil.recipe.height = 1;
  foil.recipe.xgrid = 100;
  foil.source.file = "foil.pxn";
  for (int k = 1; k < 3; ++k) foil.levels.push_back({plate(k), 0.01 * (1 << k), 1e-3 * k});
  scene.foils.push_back(foil);
  for (std::int32_t i = 1; i <= instances; ++i) scene.instances.push_back(at(i, 0));
  return scene;
}

// Every instance has the levels, which share their meshes.
TEST(Compile, LevelsOfFoil) {
  const pan::Model model = load(leveled_scene(3));
  ASSERT_EQ(model.meshes().size(), 3u);
  ASSERT_EQ(model.levels().size(), 6u);
  for (std::uint32_t i = 0; i < 3; ++i) {
    const auto levels = model.levels(i);
    ASSERT_EQ(levels.size(), 2u);
    for (std::uint32_t k = 0; k < 2; ++k) {
      EXPECT_EQ(levels[k].instance, i);
      EXPECT_EQ(levels[k].detail, 0.02 * (k + 1));
      EXPECT_EQ(levels[k].error, 1e-3 * (k + 1));
      EXPECT_EQ(levels[k].material, model.instances()[i].material);
      EXPECT_EQ(model.meshes()[levels[k].mesh].origin[0], k + 1 + 0.5);
    }
  }
  EXPECT_EQ(model.sheets()[0].mesh, model.instances()[0].mesh);
}

// Instances that are stretched, or that have decals, show the finest mesh alone.
TEST(Compile, SomeInstancesHaveNoLevels) {
  scene::Scene scene = leveled_scene(4);
  scene.nodes[1].parent_from_node.scale = Vec3(2, 1, 1);
  scene.nodes[2].parent_from_node.scale = Vec3(-3, 3, 3);
  scene.textures.push_back({"t", 1, 1, std::vector<std::uint8_t>(4, 255), false});
  scene::Decal decal;
  decal.instance = 2;
  decal.texture = 0;
  decal.at = Vec3(0.5, 0.5, 0);
  decal.normal = Vec3(0, 0, 1);
  scene.decals.push_back(decal);
  const pan::Model model = load(scene);
  EXPECT_EQ(model.levels(0).size(), 0u);
  EXPECT_EQ(model.levels(1).size(), 2u);
  EXPECT_EQ(model.levels(2).size(), 0u);
  EXPECT_EQ(model.levels(3).size(), 2u);
}

// What the nearest pixel does not see is not stored; said once.
TEST(Compile, ABudgetLeavesFineFoilOut) {
  scene::Scene scene = leveled_scene(2);
  scene.budget.nearest = 100;
  scene.budget.ifov = 2.5e-4;  // 25 mm
  const pan::Model model = load(scene);
  EXPECT_EQ(model.meshes().size(), 2u);
  ASSERT_EQ(model.levels().size(), 2u);
  EXPECT_EQ(model.levels()[0].detail, 0.04);
  EXPECT_EQ(model.meshes()[model.instances()[0].mesh].origin[0], 1.5);
  EXPECT_EQ(model.sheets()[0].mesh, model.instances()[0].mesh);
  EXPECT_EQ(model.mesh_tolerances().size(), 2u);
  DiagnosticLog log;
  ASSERT_TRUE(compiled(scene, {}, log));
  ASSERT_EQ(log.entries().size(), 1u) << to_text(log);
  EXPECT_EQ(log.entries()[0].code, Code("N2024"));
  // on a node of twice the size a pixel sees half as much of the sheet
  scene.nodes[1].parent_from_node.scale = Vec3(2);
  const pan::Model other = load(scene);
  EXPECT_EQ(other.meshes().size(), 3u);
  EXPECT_EQ(other.meshes()[other.instances()[0].mesh].origin[0], 0.5);
  EXPECT_EQ(other.meshes()[other.instances()[1].mesh].origin[0], 1.5);
  // nearer, all of it
  scene.budget.nearest = 20;
  EXPECT_EQ(load(scene).levels().size(), 4u);
}

TEST(Compile, BytesDoNotDependOnThreads) {
  scene::Scene scene = scene_with_nodes(40);
  for (std::int32_t i = 0; i < 40; ++i) {
    scene.shapes.push_back(
        geometry::Sphere{1 + 0.1 * i, {{static_cast<std::uint32_t>(i + 5), 17}}});
    scene.instances.push_back(at(i + 1, i));
  }
  DiagnosticLog log;
  const auto one = compiled(scene, {}, log, Job({1, {}}));
  for (const std::size_t threads : {2, 5}) {
    const auto many = compiled(scene, {}, log, Job({threads, {}}));
    EXPECT_EQ(*one, *many) << threads << " threads";
  }
}

TEST(Compile, FileAndMemoryAreTheSameBytes) {
  scene::Scene scene = scene_with_nodes(1);
  scene.shapes = {plate(0)};
  scene.instances = {at(1, 0)};
  DiagnosticLog log;
  const auto path = std::filesystem::temp_directory_path() /
                    ("panwright-compile-" + std::to_string(::getpid()) + ".pan");
  const auto report = compile(scene, {}, path, log);
  ASSERT_TRUE(report) << to_text(log);
  const auto bytes = compiled(scene, {}, log);
  const auto file = read_file(path, 1 << 20, log);
  std::filesystem::remove(path);
  ASSERT_TRUE(file);
  EXPECT_EQ(report->bytes, bytes->size());
  EXPECT_EQ(*file, std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()));
  EXPECT_EQ(report->triangles, 2u);
}

TEST(Compile, PositionsKeepPrecisionFarFromTheOrigin) {
  // a plate 1e7 m away: float32 alone would round to 1 m
  scene::Scene scene = scene_with_nodes(1);
  scene.shapes = {plate(1e7 + 0.123456789)};
  scene.instances = {at(1, 0)};
  const pan::Model model = load(scene);
  const auto& mesh = model.meshes()[0];
  const double x = mesh.origin[0] + static_cast<double>(model.mesh(0).positions[0].x);
  EXPECT_NEAR(x, 1e7 + 0.123456789, 4e-9);
  EXPECT_LE(mesh.error, 2e-7);
}

TEST(Compile, StoresTheErrorAchieved) {
  scene::Scene scene = scene_with_nodes(2);
  scene.shapes = {geometry::Sphere{1, {{100, 60}}}, geometry::Sphere{2, {}}};
  scene.instances = {at(1, 0), at(2, 1)};
  Options options;
  options.max_error = 5e-4;
  const pan::Model model = load(scene, options);
  // physics: R(1 − cos(Δθ/2)cos(Δφ/2)) bounds it, and the measured value is within 0.1 % of that
  const double bound = 1 - std::cos(kPi / 200) * std::cos(kPi / 60);
  EXPECT_LE(model.meshes()[0].error, bound * 1.0001);
  EXPECT_GE(model.meshes()[0].error, bound * 0.999);
  EXPECT_LE(model.meshes()[1].error, 5e-4);
  EXPECT_GE(model.meshes()[1].error, 2.5e-4);
}

TEST(Compile, ATextureAroundTheSphereGivesTexcoords) {
  scene::Scene scene = scene_with_nodes(2);
  scene.shapes = {plate(0)};
  scene.textures.push_back({"t.png", 1, 1, {1, 2, 3, 255}, false});
  scene.instances = {at(1, 0), at(2, 0)};
  scene.instances[1].texture = 0;
  scene.instances[1].mapping = scene::Mapping::sphere;
  scene.instances[1].texture_from_shape = matrix_from_trs({5, 5, 5}, {1, 0, 0, 0}, Vec3(1));
  const pan::Model model = load(scene);
  EXPECT_EQ(model.meshes().size(), 2u) << "the plain plate carries no coordinates";
  EXPECT_TRUE(model.mesh(0).texcoords.empty());
  EXPECT_EQ(model.mesh(1).texcoords.size(), model.mesh(1).positions.size());
}

TEST(Compile, SaysWhereATooFineShapeStands) {
  scene::Scene scene = scene_with_nodes(1);
  scene.shapes = {geometry::Sphere{1, {{1000, 1000}}}};
  scene.instances = {at(1, 0)};
  Options options;
  options.max_triangles = 1000;
  DiagnosticLog log;
  scene.shapes.push_back(plate(0));
  scene.instances.push_back(at(1, 1));
  const auto bytes = compiled(scene, options, log);
  ASSERT_TRUE(bytes) << "the plate can be made";
  DiagnosticLog reading;
  auto model = pan::Model::from_bytes(*bytes, "test.pan", reading);
  ASSERT_TRUE(model && model->check(reading)) << to_text(reading);
  EXPECT_EQ(model->instances().size(), 1u);
  ASSERT_EQ(log.entries().size(), 1u);
  EXPECT_EQ(log.entries()[0].code, Code("E2003"));
  EXPECT_NE(log.entries()[0].message.find("model.pxn:3:7"), std::string::npos);
  // with the text at hand the place is the diagnostic's own, but where two files have the name
  const auto text =
      std::make_shared<const std::string>("<a>\r\n<b>\r\n \xc3\xa9    <sphere r='1'/>");
  for (const char* other : {"b/other_model.pxn", "b/model.pxn"}) {
    DiagnosticLog reading_too;
    reading_too.sources().add({other, text});
    reading_too.sources().add({"a/model.pxn", text});
    ASSERT_TRUE(compiled(scene, options, reading_too));
    ASSERT_EQ(reading_too.entries().size(), 1u);
    const Diagnostic& entry = reading_too.entries()[0];
    if (std::string_view(other) == "b/model.pxn") {
      EXPECT_EQ(entry.where.file, kNoFile);
      continue;
    }
    EXPECT_EQ(entry.where.file, 1u);
    EXPECT_EQ(text->substr(entry.where.begin, entry.where.end - entry.where.begin), "sphere");
    EXPECT_EQ(entry.message.find("model.pxn"), std::string::npos);
  }
}

// Segments that a text allows and no memory should be taken for: refused before anything is made.
TEST(Compile, ShapesOfTooManySegmentsAreRefusedWhereTheyStand) {
  const geometry::Counts counts{.around = 1'000'000, .along = 40};
  for (const geometry::Shape& shape :
       {geometry::Shape(geometry::Ellipsoid{.radii = Vec3(1), .counts = counts}),
        geometry::Shape(geometry::Torus{.radius = 2, .tube_radius = 1, .counts = counts}),
        geometry::Shape(geometry::Sphere{1, {{5000, 5000}}})}) {
    scene::Scene scene = scene_with_nodes(1);
    scene.shapes = {shape};
    scene.instances = {at(1, 0)};
    DiagnosticLog log;
    ASSERT_TRUE(compiled(scene, {.max_error = 1e-3}, log));
    ASSERT_EQ(log.entries().size(), 1u) << to_text(log);
    EXPECT_EQ(log.entries()[0].code, Code("E2003"));
    EXPECT_NE(log.entries()[0].message.find("model.pxn:3:7: this shape needs "), std::string::npos);
    EXPECT_NE(log.entries()[0].message.find("at most 33554432"), std::string::npos);
  }
}

TEST(Compile, TheLimitIsForAllMeshesTogether) {
  scene::Scene scene = scene_with_nodes(1);
  for (std::uint32_t i = 0; i < 5; ++i) {
    scene.shapes.push_back(geometry::Sphere{1, {{10, 20 + i}}});
    scene.instances.push_back(at(1, static_cast<std::int32_t>(i)));
  }
  Options options;
  options.max_triangles = 1000;  // two of them, 360 and 378, fit
  DiagnosticLog log;
  const auto bytes = compiled(scene, options, log);
  ASSERT_TRUE(bytes);
  EXPECT_EQ(log.errors(), 3u);
}

TEST(Compile, NamesOfAnyBytesBecomeUtf8) {
  scene::Scene scene = scene_with_nodes(1);
  scene.shapes = {plate(0)};
  scene.instances = {at(1, 0)};
  scene.instances[0].source.file = "sonde_\xe9.pxn";
  scene.nodes[1].name = "sonde_\xe9";
  scene.inputs = {{"sonde_\xe9.pxn", hash128({}), 12}};
  const pan::Model model = load(scene);  // checks the file
  EXPECT_EQ(model.node_name(1), "sonde_\xef\xbf\xbd");
}

TEST(Compile, AnEmptySceneIsAModel) {
  scene::Scene scene;
  scene.nodes.push_back({"root", scene::kNone, {}, {}});
  const pan::Model model = load(scene);
  EXPECT_EQ(model.instances().size(), 0u);
  EXPECT_FALSE(model.world_bounds());
}

TEST(Compile, ProvenanceNamesInputsAndOptions) {
  scene::Scene scene = scene_with_nodes(1);
  scene.shapes = {plate(0)};
  scene.instances = {at(1, 0)};
  scene.inputs = {{"model.pxn", hash128({}), 12}};
  const pan::Model a = load(scene);
  EXPECT_EQ(a.string(a.inputs()[0].path), "model.pxn");
  EXPECT_NE(a.options().find("max_error=need"), std::string_view::npos);
  Options options;
  options.max_error = 0.25;
  EXPECT_NE(load(scene, options).options().find("max_error=0.25"), std::string_view::npos);
  EXPECT_EQ(a.sources()[0].line, 3u);
  scene.inputs[0].hash.low ^= 1;
  const pan::Model b = load(scene);
  EXPECT_FALSE(a.build_id() == b.build_id());
}

}  // namespace
}  // namespace panwright::compiler::compile_test
