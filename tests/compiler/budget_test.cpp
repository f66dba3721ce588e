// From a need to a file: what is asked, what is made, and what is stored of both.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "compiler/compile.h"
#include "compiler/tolerance.h"
#include "pan/model.h"
#include "tests/compiler/facet_sums.h"

namespace panwright::compiler::budget_test {
namespace {

using pan::layout::ToleranceReason;

geometry::Sphere ball(double radius) {
  geometry::Sphere sphere;
  sphere.radius = radius;
  return sphere;
}

// One instance of each shape, each at a node of its own scale.
scene::Scene scene_of(const std::vector<std::pair<geometry::Shape, Vec3>>& parts) {
  scene::Scene scene;
  scene.nodes.push_back({"root", scene::kNone, {}, {}});
  scene.materials.emplace_back();
  for (const auto& [shape, scale] : parts) {
    const auto i = static_cast<std::int32_t>(scene.shapes.size());
    scene.nodes.push_back({"n", 0, {Vec3(5 * i, 0, 0), {1, 0, 0, 0}, scale}, {}});
    scene.shapes.push_back(shape);
    scene::Instance instance;
    instance.node = i + 1;
    instance.shape = i;
    scene.instances.push_back(instance);
  }
  return scene;
}

pan::Model model_of(const scene::Scene& scene, const Options& options = {}) {
  EXPECT_EQ(scene::check(scene), "");
  DiagnosticLog log;
  const auto bytes = compiled(scene, options, log);
  EXPECT_TRUE(bytes) << to_text(log);
  auto model = pan::Model::from_bytes(*bytes, "budget.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return *std::move(model);
}

ToleranceReason reason(const pan::Model& model, std::size_t mesh) {
  return ToleranceReason{model.mesh_tolerances()[mesh].reason};
}

TEST(Budget, NothingIsStoredWhenNothingIsAsked) {
  const pan::Model model = model_of(scene_of({{ball(1), Vec3(1)}}));
  EXPECT_FALSE(model.budget());
  EXPECT_TRUE(model.mesh_tolerances().empty());
  EXPECT_LE(model.meshes()[0].error, kDefaultTolerance);
}

TEST(Budget, TheNeedIsStoredWithWhatCameOfIt) {
  scene::Scene scene =
      scene_of({{ball(1), Vec3(1)},
                {geometry::Sphere{1, geometry::SphereCounts{8, 12}, -1, 1, {}}, Vec3(1)},
                {ball(0.15), Vec3(1)}});
  scene.budget.nearest = 20;
  scene.budget.ifov = 1e-4;
  scene.budget.pixels = 50;
  scene.budget.flux = 1e-2;
  const pan::Model model = model_of(scene);
  ASSERT_TRUE(model.budget());
  EXPECT_EQ(model.budget()->tolerance, 0);
  EXPECT_EQ(model.budget()->nearest, 20);
  EXPECT_EQ(model.budget()->ifov, 1e-4);
  EXPECT_EQ(model.budget()->pixels, 50);
  EXPECT_EQ(model.budget()->flux, 1e-2);
  EXPECT_EQ(model.budget()->centroid, 0);
  // its share of the model's flux (compiler/fit.h): more than its own, as it sends little of it
  EXPECT_EQ(model.budget()->smallest,
            std::min(model.mesh_tolerances()[0].tolerance, model.mesh_tolerances()[2].tolerance));
  EXPECT_GT(model.budget()->smallest, 1e-2 * 0.15 / kFluxFactor);
  ASSERT_EQ(model.mesh_tolerances().size(), 3u);
  EXPECT_EQ(reason(model, 0), ToleranceReason::flux);
  EXPECT_EQ(reason(model, 1), ToleranceReason::explicit_counts);
  EXPECT_EQ(model.mesh_tolerances()[1].tolerance, 0);
  EXPECT_EQ(reason(model, 2), ToleranceReason::flux);
  for (const std::size_t i : {0u, 2u}) {
    EXPECT_LE(model.meshes()[i].error, model.mesh_tolerances()[i].tolerance);
    EXPECT_GE(model.meshes()[i].error, 0.5 * model.mesh_tolerances()[i].tolerance);
  }
  scene.budget.pixels = 0.5;
  const pan::Model close = model_of(scene);
  EXPECT_EQ(reason(close, 0), ToleranceReason::pixels);
  EXPECT_DOUBLE_EQ(close.mesh_tolerances()[0].tolerance, 1e-3);
}

TEST(Budget, TolerancesAreMetresInTheWorld) {
  scene::Scene scene = scene_of({{ball(1), Vec3(1)}, {ball(2), {10, 10, 10}}});
  scene.budget.tolerance = 1e-2;
  const pan::Model model = model_of(scene);
  EXPECT_DOUBLE_EQ(model.mesh_tolerances()[0].tolerance, 1e-2);
  EXPECT_DOUBLE_EQ(model.mesh_tolerances()[1].tolerance, 1e-3);
  EXPECT_LE(10 * model.meshes()[1].error, 1e-2);
  // along a chain of nodes, by its largest stretch
  scene.nodes[2].parent = 1;
  scene.nodes[1].parent_from_node.scale = {1, 1, -4};
  scene.nodes[1].parent_from_node.rotation = quat_from_fixed_xyz({0.3, 0.2, 0.1});
  EXPECT_DOUBLE_EQ(model_of(scene).mesh_tolerances()[1].tolerance, 1e-2 / 40);
}

TEST(Budget, OneMeshServesTheMostDemandingInstance) {
  scene::Scene scene = scene_of({{ball(1), Vec3(1)}, {ball(1), Vec3(1)}, {ball(1), Vec3(0.5)}});
  scene.budget.tolerance = 1e-2;
  scene.instances[1].tolerance = 1e-3;
  scene.instances[2].tolerance = 1e-3;
  const pan::Model model = model_of(scene);
  ASSERT_EQ(model.meshes().size(), 1u);
  EXPECT_DOUBLE_EQ(model.mesh_tolerances()[0].tolerance, 1e-3);
  EXPECT_EQ(reason(model, 0), ToleranceReason::shape);
  EXPECT_EQ(model.budget()->smallest, 1e-3);
}

TEST(Budget, AnInstanceAloneAsks) {
  scene::Scene scene = scene_of({{ball(1), Vec3(1)}, {ball(2), Vec3(1)}});
  scene.instances[1].tolerance = 0.25;
  const pan::Model model = model_of(scene);
  ASSERT_TRUE(model.budget());
  EXPECT_EQ(model.budget()->tolerance, 0);
  EXPECT_EQ(reason(model, 0), ToleranceReason::tolerance);
  EXPECT_EQ(model.mesh_tolerances()[0].tolerance, kDefaultTolerance);
  EXPECT_EQ(reason(model, 1), ToleranceReason::shape);
  EXPECT_EQ(model.mesh_tolerances()[1].tolerance, 0.25);
}

TEST(Budget, TheCommandLineOverridesEverything) {
  scene::Scene scene = scene_of({{ball(1), Vec3(1)}, {ball(2), Vec3(1)}});
  scene.budget.tolerance = 1e-5;
  scene.instances[1].tolerance = 0.25;
  Options options;
  options.max_error = 0.03;
  const pan::Model model = model_of(scene, options);
  EXPECT_EQ(model.budget()->tolerance, 0.03);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(model.mesh_tolerances()[i].tolerance, 0.03);
    EXPECT_EQ(reason(model, i), ToleranceReason::command_line);
  }
}

// The promise itself: parts made for a flux or a photocentre have it, from wherever they are seen.
TEST(Budget, PartsKeepTheFluxAndThePhotocentreTheyWereMadeFor) {
  scene::Scene scene = scene_of({{ball(0.5), Vec3(3)}});
  const double radius = 1.5, pixel = 200 * 5e-5;  // metres
  for (const bool by_flux : {true, false}) {
    scene.budget = {};
    scene.budget.nearest = 200;
    scene.budget.ifov = 5e-5;
    (by_flux ? scene.budget.flux : scene.budget.centroid) = by_flux ? 0.02 : 0.25;
    const pan::Model model = model_of(scene);
    EXPECT_EQ(reason(model, 0), by_flux ? ToleranceReason::flux : ToleranceReason::centroid);
    geometry::Mesh mesh;
    const pan::MeshView view = model.mesh(0);
    for (const auto& p : view.positions) mesh.positions.push_back(3.0 * Vec3(p.x, p.y, p.z));
    for (const auto& n : view.normals) mesh.normals.emplace_back(n.x, n.y, n.z);
    for (std::size_t i = 0; i < view.indices.size(); i += 3)
      mesh.triangles.push_back({view.indices[i], view.indices[i + 1], view.indices[i + 2]});
    double worst_flux = 0, worst_centroid = 0;
    for (const double phase : {0.0, 45.0, 90.0, 120.0}) {
      const double a = phase * kDegree;
      const double flux = 2.0 / 3 * (std::sin(a) + (kPi - a) * std::cos(a));
      const double offset = kPi / 8 * std::sin(a) * (1 + std::cos(a)) / flux;
      for (int i = 0; i < 12; ++i) {
        const Vec3 v = glm::normalize(Vec3(std::cos(2.4 * i), std::sin(2.4 * i), 0.17 * i - 0.9));
        const Vec3 p = glm::normalize(glm::cross(v, Vec3(0.3, -0.5, 0.1 * i)));
        const support::Seen seen = support::seen_by(mesh, std::cos(a) * v + std::sin(a) * p, v, 6);
        worst_flux = std::max(worst_flux, std::fabs(seen.flux / (flux * radius * radius) - 1));
        const Vec3 miss = seen.photocentre() - offset * radius * p;
        worst_centroid =
            std::max(worst_centroid, glm::length(miss - v * glm::dot(miss, v)) / pixel);
      }
    }
    if (by_flux)
      EXPECT_LT(worst_flux, 0.02);  // measured 0.0077
    else
      EXPECT_LT(worst_centroid, 0.25);  // measured 0.090
  }
}

TEST(Budget, NearlyFlatAndUpsideDownWorldsAreBounded) {
  scene::Scene scene =
      scene_of({{ball(1), {1e-12, 1, 1}}, {ball(1), Vec3(1e-200)}, {ball(1), {1, -1, 1}}});
  scene.budget.flux = 0.1;
  Options options;
  options.max_triangles = 100000;
  DiagnosticLog log;
  const auto bytes = compiled(scene, options, log);
  ASSERT_TRUE(bytes);
  // a disc of which nothing is known to be enough is too fine to be made; the others are
  EXPECT_EQ(log.errors(), 1u) << to_text(log);
  EXPECT_TRUE(log.contains(Code("E2003")));
  DiagnosticLog reading;
  auto model = pan::Model::from_bytes(*bytes, "x", reading);
  ASSERT_TRUE(model && model->check(reading)) << to_text(reading);
}

TEST(Budget, KeypointsComeThrough) {
  scene::Scene scene = scene_of({{ball(1), Vec3(1)}});
  scene.keypoints = {{"tip", 1, {0.1, 0.2, 0.3}, {}}, {"\xe9", 0, {1e9, 0, 0}, {}}};
  const pan::Model model = model_of(scene);
  ASSERT_EQ(model.keypoints().size(), 2u);
  EXPECT_EQ(model.keypoint_name(0), "tip");
  EXPECT_EQ(model.keypoints()[0].node, 1u);
  EXPECT_EQ(model.keypoints()[0].position[2], 0.3);
  EXPECT_EQ(model.keypoint_name(1), "\xef\xbf\xbd");
}

TEST(Budget, MaterialsWithMapsHaveTexcoords) {
  auto bare = std::make_shared<geometry::Mesh>();
  bare->positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  bare->normals.assign(3, {0, 0, 1});
  bare->triangles = {{0, 1, 2}};
  scene::Scene scene = scene_of({{ball(1), Vec3(1)}, {ball(1), Vec3(1)}, {bare, Vec3(1)}});
  scene.textures.push_back({"t.png", 1, 1, {1, 2, 3, 255}, false});
  scene.materials.emplace_back();
  scene.materials[1].maps.normal = 0;
  scene.instances[1].material = scene.instances[2].material = 1;
  const pan::Model model = model_of(scene);  // the check asks for them
  ASSERT_EQ(model.meshes().size(), 3u);
  EXPECT_TRUE(model.mesh(0).texcoords.empty());
  EXPECT_FALSE(model.mesh(1).texcoords.empty());
  EXPECT_EQ(model.mesh(2).texcoords.size(), 3u) << "a mesh without any takes a corner";
}

}  // namespace
}  // namespace panwright::compiler::budget_test
