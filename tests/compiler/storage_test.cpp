// Storage in few bits: the error is stated, within the budget, and opens no crack.
#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "compiler/compile.h"
#include "pan/model.h"

namespace panwright::compiler::storage_test {
namespace {

constexpr double kTop = 0.3137;  // where the cylinder ends and the cone begins
constexpr const char* kForms[] = {"lossy:11", "lossy:14", "lossy"};

// A cylinder and a cone on it, at odd places and angles, under a turned node; and a sphere.
scene::Scene stack(double tolerance) {
  scene::Scene out;
  out.nodes.push_back({"root", scene::kNone, {}, {}});
  out.materials.emplace_back();
  if (tolerance > 0) out.budget.tolerance = tolerance;
  const auto add = [&](const geometry::Shape& shape, const scene::Transform& where) {
    out.nodes.push_back({"n", 0, where, {}});
    out.shapes.push_back(shape);
    scene::Instance instance;
    instance.node = static_cast<std::int32_t>(out.nodes.size()) - 1;
    instance.shape = static_cast<std::int32_t>(out.shapes.size()) - 1;
    out.instances.push_back(instance);
  };
  geometry::Cylinder cylinder;
  cylinder.radius = 0.777;
  cylinder.height = 2.31;
  geometry::Cone cone;
  cone.bottom_radius = 0.777;
  cone.top_radius = 0.123;
  cone.height = 0.911;
  geometry::Sphere sphere;
  sphere.radius = 1.234;
  scene::Transform low, high, aside;
  low.translation = {0.1, 0.2, kTop - 2.31 / 2};
  high.translation = {0.1, 0.2, kTop + 0.911 / 2};
  aside.translation = {3.3, 0, 0};
  add(cylinder, low);
  add(cone, high);
  add(sphere, aside);
  return out;
}

pan::Model made(const scene::Scene& scene, const char* form, Report* report = nullptr) {
  DiagnosticLog log;
  Options options;
  options.storage = pan::storage_form(form).value();
  const auto path = std::filesystem::temp_directory_path() / "panwright_storage_test.pan";
  const auto done = compile(scene, options, path, log);
  EXPECT_TRUE(done) << to_text(log);
  if (report != nullptr) *report = *done;
  auto model = pan::Model::load(path, log);
  EXPECT_TRUE(model) << to_text(log);
  std::filesystem::remove(path);
  return *std::move(model);
}

std::vector<Vec3> in_world(const pan::Model& model, std::size_t index) {
  const auto& instance = model.instances()[index];
  const auto& mesh = model.meshes()[instance.mesh];
  const Mat4 world = model.world_from_nodes()[instance.node];
  std::vector<Vec3> out;
  for (const auto& p : model.mesh(instance.mesh).positions)
    out.emplace_back(world *
                     Vec4(mesh.origin[0] + p.x, mesh.origin[1] + p.y, mesh.origin[2] + p.z, 1.0));
  return out;
}

TEST(CompilerStorage, SharedCircularEdgesStayShared) {
  for (const char* form : kForms) {
    SCOPED_TRACE(form);
    const pan::Model model = made(stack(0), form);
    const auto below = in_world(model, 0), above = in_world(model, 1);
    std::size_t met = 0, on_edge = 0;
    for (const Vec3& p : below) {
      const double radius = std::hypot(p.x - 0.1, p.y - 0.2);
      if (std::fabs(p.z - kTop) > 1e-4 || radius < 0.7) continue;
      ++on_edge;
      double nearest = 1;
      for (const Vec3& q : above) nearest = std::min(nearest, glm::length(p - q));
      // measured 1e-7 with floats; one step of 11 bits is 1e-3
      met += nearest < 5e-7;
    }
    EXPECT_GT(on_edge, 20u);
    EXPECT_EQ(met, on_edge);
  }
}

TEST(CompilerStorage, TheErrorIsWithinTheTolerance) {
  for (const char* form : kForms)
    for (const double tolerance : {1e-2, 1e-4}) {
      SCOPED_TRACE(testing::Message() << form << " " << tolerance);
      Report report;
      const pan::Model model = made(stack(tolerance), form, &report);
      double moved = 0;
      for (std::size_t m = 0; m < model.meshes().size(); ++m) {
        const double each = model.mesh_streams()[m].position_error;
        moved = std::max(moved, each);
        EXPECT_LE(each, tolerance / 4);
        EXPECT_LE(model.meshes()[m].error, tolerance);
        EXPECT_GT(model.meshes()[m].error, each);
      }
      EXPECT_GT(moved, 0);
      EXPECT_EQ(report.storage.position_error, moved);
      // a quarter is 2.5e-5; of 2.5 m, 16 bits move by up to 3.3e-5
      EXPECT_EQ(report.storage.meshes_with_more_bits > 0, tolerance == 1e-4);
      // the sphere by its closed form: no vertex further from it than the mesh says
      const auto sphere = in_world(model, 2);
      double off = 0;
      for (const Vec3& p : sphere)
        off = std::max(off, std::fabs(glm::length(p - Vec3(3.3, 0, 0)) - 1.234));
      EXPECT_LE(off, model.meshes()[model.instances()[2].mesh].error);
    }
}

TEST(CompilerStorage, TheSameWhateverTheThreads) {
  for (const char* form : kForms) {
    Options options;
    options.storage = pan::storage_form(form).value();
    DiagnosticLog log;
    std::vector<std::vector<std::byte>> files;
    for (const std::size_t threads : {1u, 2u, 5u})
      run_on_threads(Job({threads, {}}),
                     [&] { files.push_back(*compiled(stack(1e-3), options, log)); });
    EXPECT_TRUE(files[0] == files[1] && files[0] == files[2]) << form;
  }
}

}  // namespace
}  // namespace panwright::compiler::storage_test
