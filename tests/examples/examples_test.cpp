// The examples: no warning, nothing inside out, nothing that floats, and the truth they promise.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <set>

#include "compiler/compile.h"
#include "geometry/mesh/check.h"
#include "geometry/tessellate/tessellate.h"
#include "pxn/pxn.h"
#include "tests/support/paths.h"
#include "tests/support/ray_caster.h"

namespace panwright::examples_test {
namespace {

namespace fs = std::filesystem;
using geometry::Mesh;

const fs::path kExamples = PANWRIGHT_SOURCE_DIR "/examples";

// What stands 2 mm apart is joined: layers over a skin, which must not be coplanar.
constexpr double kGap = 2.5e-3;  // metres

struct Example {
  const char* file;
  std::vector<std::pair<std::string, std::string>> parameters;
  std::set<std::string> frames;     // some of them
  std::set<std::string> keypoints;  // some of them
  std::size_t groups = 1;           // of shapes that touch each other
};

void PrintTo(const Example& example, std::ostream* out) {
  *out << example.file;
  for (const auto& [name, value] : example.parameters) *out << " -D " << name << "=" << value;
}

class Examples : public testing::TestWithParam<Example> {
 protected:
  void SetUp() override {
    pxn::Options options;
    options.parameters = GetParam().parameters;
    auto scene = pxn::read(kExamples / GetParam().file, options, log_);
    ASSERT_TRUE(scene) << to_text(log_);
    scene_ = std::move(*scene);
  }

  // The mesh of an instance, in the world.
  Mesh mesh_of(const scene::Instance& instance) {
    geometry::TessellationOptions options;
    options.max_error = 1e-3;
    auto mesh = geometry::tessellated(scene_.shapes[static_cast<std::size_t>(instance.shape)],
                                      options, {}, log_);
    if (!mesh) return {};
    const Mat4 place = scene::world_from_nodes(scene_)[static_cast<std::size_t>(instance.node)];
    for (Vec3& p : mesh->positions) p = Vec3(place * Vec4(p, 1));
    for (Vec3& n : mesh->normals) n = Vec3(0);
    return std::move(*mesh);
  }

  std::string name_of(const scene::Instance& instance) const {
    std::string name;
    for (std::int32_t n = instance.node; n > 0;
         n = scene_.nodes[static_cast<std::size_t>(n)].parent)
      name = "/" + scene_.nodes[static_cast<std::size_t>(n)].name + name;
    return name;
  }

  DiagnosticLog log_;
  scene::Scene scene_;
};

TEST_P(Examples, CompilesWithoutAWord) {
  const auto bytes = compiler::compiled(scene_, {}, log_);
  EXPECT_TRUE(bytes);
  EXPECT_EQ(to_text(log_), "");
  EXPECT_TRUE(scene_.budget.any()) << "examples show what a budget is";
}

TEST_P(Examples, HasItsFramesAndKeypoints) {
  std::set<std::string> frames;
  std::set<std::string> keypoints;
  for (const scene::Frame& frame : scene_.frames) frames.insert(frame.name);
  for (const scene::Keypoint& keypoint : scene_.keypoints) keypoints.insert(keypoint.name);
  for (const std::string& name : GetParam().frames)
    EXPECT_TRUE(frames.contains(name))
        << name << " is not among " << testing::PrintToString(frames);
  for (const std::string& name : GetParam().keypoints)
    EXPECT_TRUE(keypoints.contains(name))
        << name << " is not among " << testing::PrintToString(keypoints);
}

TEST_P(Examples, NothingIsInsideOut) {
  for (const geometry::Shape& shape : scene_.shapes) {
    geometry::TessellationOptions options;
    options.max_error = 1e-3;
    const auto mesh = geometry::tessellated(shape, options, {}, log_);
    ASSERT_TRUE(mesh);
    const geometry::MeshReport report = geometry::check(*mesh);
    EXPECT_EQ(report.misoriented_edges, 0u);
    EXPECT_EQ(report.degenerate_triangles, 0u);
    if (report.closed) {
      EXPECT_GT(report.volume, 0) << geometry::kind_name(shape);
    }
  }
}

// Shapes are joined where an edge of one passes through another, or ends within the gap of it.
TEST_P(Examples, NothingFloats) {
  std::vector<Mesh> meshes;
  support::RayCaster caster;
  for (const scene::Instance& instance : scene_.instances) {
    meshes.push_back(mesh_of(instance));
    ASSERT_FALSE(meshes.back().triangles.empty());
    caster.add(meshes.back(), Mat4(1));
  }
  caster.build();

  std::vector<std::size_t> group(meshes.size());
  std::iota(group.begin(), group.end(), 0);
  const auto root = [&](std::size_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  // all other shapes that a segment meets
  const auto join = [&](std::size_t own, const Vec3& from, const Vec3& to) {
    const double length = glm::length(to - from);
    geometry::Ray ray{from, to - from, 0, length};
    for (int hits = 0; hits < 64 && ray.min_distance < length; ++hits) {
      const auto hit = caster.closest(ray);
      if (!hit) return;
      if (hit->instance != own) group[root(own)] = root(hit->instance);
      ray.min_distance = std::nextafter(hit->distance, 1e30) + 1e-7;
    }
  };
  for (std::size_t i = 0; i < meshes.size(); ++i)
    for (const auto& [a, b, c] : meshes[i].triangles) {
      const Vec3 p[3] = {meshes[i].positions[a], meshes[i].positions[b], meshes[i].positions[c]};
      const Vec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
      const double area = glm::length(normal);
      for (int k = 0; k < 3; ++k) {
        join(i, p[k], p[(k + 1) % 3]);
        if (area > 0) join(i, p[k] - normal * (kGap / area), p[k] + normal * (kGap / area));
      }
    }

  std::set<std::size_t> groups;
  for (std::size_t i = 0; i < meshes.size(); ++i) groups.insert(root(i));
  EXPECT_EQ(groups.size(), GetParam().groups);
  if (groups.size() == GetParam().groups) return;
  const std::size_t largest = root(0);
  for (std::size_t i = 0; i < meshes.size(); ++i)
    if (root(i) != largest)
      ADD_FAILURE() << name_of(scene_.instances[i]) << " touches nothing else";
}

INSTANTIATE_TEST_SUITE_P(
    All, Examples,
    testing::Values(
        Example{"servicer/servicer.pxn",
                {},
                {"docking/port", "camera_wide/camera", "camera_narrow/camera", "lidar/boresight",
                 "inspection/camera", "star_tracker_a/boresight", "star_tracker_b/boresight",
                 "high_gain/dish/boresight", "main_engine/plume", "cluster0/plus_x/plume",
                 "cluster3/minus_z/plume", "arm/gripper/grip"},
                {"corner0", "corner7", "wing_left/tip_left", "wing_right/tip_right", "tag0_middle",
                 "high_gain/dish/rim3"}},
        Example{"servicer/servicer.pxn",
                {{"panels", "5"}, {"array_angle", "-30deg"}, {"bays", "2"}},
                {},
                {}},
        Example{"client/client.pxn", {}, {"grip", "plume", "axis"}, {"ring0", "skirt7", "bell3"}},
        Example{"cubesat/cubesat.pxn", {}, {"camera", "separation"}, {"rail0_top", "antenna3_tip"}},
        Example{"cubesat/cubesat.pxn", {{"units", "1"}}, {}, {}},
        Example{"cubesat/cubesat.pxn", {{"units", "6"}, {"wings", "1"}}, {}, {}},
        Example{"calibration/board.pxn", {}, {"board"}, {"tag0_0", "tag11_3"}},
        Example{"calibration/board.pxn", {{"columns", "6"}, {"rows", "4"}}, {}, {"tag23_3"}},
        Example{"calibration/plates.pxn", {}, {"wedge"}, {"middle0", "middle9"}},
        Example{"calibration/spheres.pxn", {}, {"camera"}, {"centre0", "centre3"}, 8}));

}  // namespace
}  // namespace panwright::examples_test
