// What a budget lets a model do without.
#include "compiler/fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "compiler/compile.h"
#include "compiler/internal/approach.h"
#include "compiler/internal/fit.h"
#include "geometry/mesh/distance.h"
#include "geometry/tessellate/tessellate.h"
#include "image/srgb.h"
#include "pan/model.h"
#include "tests/compiler/facet_sums.h"

namespace panwright::compiler::fit_test {
namespace {

using geometry::Mesh;
using geometry::MeshShape;
using internal::Fitted;

scene::Scene empty_scene() {
  scene::Scene scene;
  scene.nodes.push_back({"root", scene::kNone, {}, {}});
  scene.materials.emplace_back();
  scene.budget.nearest = 1e4;
  scene.budget.ifov = 1e-4;  // a pixel sees 1 m
  scene.budget.pixels = 0.25;
  return scene;
}

std::size_t add(scene::Scene& scene, geometry::Shape shape, const Vec3& at,
                const std::string& name = "part", std::int32_t material = 0) {
  scene.nodes.push_back({name, 0, {at, {1, 0, 0, 0}, Vec3(1)}, {}});
  scene.shapes.push_back(std::move(shape));
  scene::Instance instance;
  instance.node = static_cast<std::int32_t>(scene.nodes.size() - 1);
  instance.shape = static_cast<std::int32_t>(scene.shapes.size() - 1);
  instance.material = material;
  scene.instances.push_back(instance);
  return scene.instances.size() - 1;
}

geometry::Sphere ball(double radius) {
  geometry::Sphere sphere;
  sphere.radius = radius;
  return sphere;
}

Fitted fitted(const scene::Scene& scene) {
  EXPECT_EQ(scene::check(scene), "");
  DiagnosticLog log;
  Fitted out = internal::fitted_to_budget(scene, {}, nullptr, log, {});
  EXPECT_EQ(scene::check(out.scene()), "");
  return out;
}

// A ball of 1 m and 400 small ones of 0.5 to 200 mm, apart from each other.
scene::Scene crowd() {
  scene::Scene scene = empty_scene();
  add(scene, ball(1), Vec3(0));
  for (int i = 0; i < 400; ++i) {
    const double angle = 0.7 * i, radius = 5e-4 * std::pow(400, (i * 37 % 400) / 399.0);
    add(scene, ball(radius), Vec3(2 * std::cos(angle), 2 * std::sin(angle), 0.01 * i - 2));
  }
  return scene;
}

TEST(Fit, WithoutACameraAndATermNothingGoes) {
  for (const bool camera : {false, true}) {
    scene::Scene scene = crowd();
    if (camera)
      scene.budget.pixels.reset();
    else
      scene.budget.nearest.reset(), scene.budget.flux = 0.5;
    const Fitted out = fitted(scene);
    EXPECT_FALSE(out.report.asked);
    EXPECT_EQ(out.scene().instances.size(), scene.instances.size());
  }
  // pixels alone say nothing of light
  const Fitted out = fitted(crowd());
  EXPECT_TRUE(out.report.asked);
  EXPECT_EQ(out.report.pieces_left_out, 0u);
}

TEST(Fit, TheSmallestGoWhileTheirAreasAreUnderTheFlux) {
  for (const double flux : {1e-3, 1e-2, 0.1}) {
    scene::Scene scene = crowd();
    scene.budget.flux = flux;
    const Fitted out = fitted(scene);
    std::vector<double> radii, left;
    for (const auto& instance : scene.instances)
      radii.push_back(
          std::get<geometry::Sphere>(scene.shapes[static_cast<std::size_t>(instance.shape)])
              .radius);
    for (const auto& instance : out.scene().instances)
      left.push_back(
          std::get<geometry::Sphere>(out.scene().shapes[static_cast<std::size_t>(instance.shape)])
              .radius);
    std::sort(radii.begin(), radii.end());
    std::sort(left.begin(), left.end());
    const std::size_t gone = radii.size() - left.size();
    ASSERT_EQ(gone, out.report.pieces_left_out);
    ASSERT_GT(gone, 10u);
    // the smallest went
    EXPECT_EQ(left.front(), radii[gone]);
    // what the model shows: the large ball, and what stands beside it, which may be as much again
    double area = 0;
    for (std::size_t i = 0; i < gone; ++i) area += kPi * radii[i] * radii[i];
    const double whole = std::accumulate(radii.begin(), radii.end(), 0.0,
                                         [](double sum, double r) { return sum + kPi * r * r; });
    EXPECT_LE(2 * area, kLeftOutShare * flux * whole);
    EXPECT_LE(out.report.flux_left_out, kLeftOutShare * flux);
    EXPECT_GE(out.report.flux_left_out, 2 * area / whole);
    // and no more would fit: a box's corner shows 1.5 of a ball's disc and more
    const double next = kPi * radii[gone] * radii[gone];
    EXPECT_GT(2 * 2.3 * (area + next), kLeftOutShare * flux * kPi);
  }
}

TEST(Fit, ATrussDoesNotVanishMemberByMember) {
  scene::Scene scene = empty_scene();
  add(scene, ball(1), Vec3(0));
  for (int i = 0; i < 1000; ++i)
    add(scene, geometry::Cylinder{.radius = 2e-3, .height = 0.5}, Vec3(2, 0, 0.01 * i));
  scene.budget.flux = 0.01;
  const Fitted out = fitted(scene);
  // one member shows 2 cm² at most, twice that counts: 2 of them are all that goes
  EXPECT_LE(out.report.pieces_left_out, 3u);
  scene.instances.resize(2);
  EXPECT_EQ(fitted(scene).report.pieces_left_out, 1u);
}

TEST(Fit, WhatIsWiderThanItsPixelsStays) {
  scene::Scene scene = empty_scene();
  add(scene, ball(10), Vec3(0));
  add(scene, geometry::Cylinder{.radius = 5e-3, .height = 2}, Vec3(11, 0, 0), "whip");
  scene.budget.flux = 0.05;
  EXPECT_EQ(fitted(scene).report.pieces_left_out, 1u);
  // its box is 1.41 cm across, the tolerance 0.25 px of 5 cm
  scene.budget.nearest = 500;
  EXPECT_EQ(fitted(scene).report.pieces_left_out, 0u);
  scene.budget.nearest = 600;
  EXPECT_EQ(fitted(scene).report.pieces_left_out, 1u);
}

TEST(Fit, ThePhotocentreHoldsToo) {
  scene::Scene scene = empty_scene();
  add(scene, ball(1), Vec3(0));
  add(scene, ball(0.02), Vec3(40, 0, 0), "far");
  add(scene, ball(0.02), Vec3(0, 0, 2), "near");
  scene.budget.flux = 0.1;
  EXPECT_EQ(fitted(scene).report.pieces_left_out, 2u);
  // what the box of the far one shows, twice, is at most 1.4e-3 of the ball's disc, 40 m away
  scene.budget.centroid = 0.02;  // px of 1 m, a quarter of it for this
  const Fitted out = fitted(scene);
  ASSERT_EQ(out.report.pieces_left_out, 1u);
  EXPECT_EQ(out.report.left_out.front().name, "near");
  EXPECT_LE(out.report.centroid_left_out, kLeftOutShare * 0.02);
}

TEST(Fit, WhatSomebodyAskedForStays) {
  scene::Scene scene = empty_scene();
  scene.materials.emplace_back();
  scene.materials[1].specular_brdf = materials::Retroreflector{};
  add(scene, ball(1), Vec3(0));
  add(scene, ball(0.001), Vec3(2, 0, 0), "plain");
  const std::size_t own = add(scene, ball(0.001), Vec3(3, 0, 0), "own");
  scene.instances[own].tolerance = 1e-4;
  add(scene, ball(0.001), Vec3(4, 0, 0), "corner cube", 1);
  add(scene, ball(0.001), Vec3(5, 0, 0), "scaled");
  scene::Joint joint;
  joint.name = "general";
  joint.node = scene.instances.back().node;
  joint.kind = scene::JointKind::general;
  scene.joints.push_back(joint);
  scene.budget.flux = 0.1;
  const Fitted out = fitted(scene);
  ASSERT_EQ(out.report.pieces_left_out, 1u);
  EXPECT_EQ(out.report.left_out.front().name, "plain");
  // and --max-error decides everything
  DiagnosticLog log;
  EXPECT_FALSE(internal::fitted_to_budget(scene, 1e-3, nullptr, log, {}).report.asked);
}

Mesh boxes(const std::vector<std::pair<Vec3, double>>& places) {
  Mesh out;
  DiagnosticLog log;
  for (const auto& [at, size] : places) {
    const auto box = geometry::tessellated(geometry::Box{.size = Vec3(size)}, {}, {}, log);
    const auto base = static_cast<std::uint32_t>(out.positions.size());
    for (const Vec3& p : box->positions) out.positions.push_back(p + at);
    out.normals.insert(out.normals.end(), box->normals.begin(), box->normals.end());
    for (const auto& t : box->triangles)
      out.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  out.closed = true;
  return out;
}

TEST(Fit, PiecesOfMeshesGo) {
  scene::Scene scene = empty_scene();
  const auto mesh = std::make_shared<const Mesh>(
      boxes({{Vec3(0), 2}, {Vec3(3, 0, 0), 0.01}, {Vec3(0, 3, 0), 0.5}, {Vec3(0, 0, 3), 0.01}}));
  add(scene, MeshShape(mesh), Vec3(0));
  scene.budget.flux = 0.01;
  const Fitted out = fitted(scene);
  EXPECT_EQ(out.report.pieces, 4u);
  EXPECT_EQ(out.report.pieces_left_out, 2u);
  EXPECT_EQ(out.report.triangles_left_out, 24u);
  const Mesh& left = *std::get<MeshShape>(out.scene().shapes[0]);
  EXPECT_EQ(left.triangles.size(), 24u);
  EXPECT_EQ(left.positions.size(), 48u);
  EXPECT_EQ(mesh->triangles.size(), 48u) << "the scene's own is untouched";
}

TEST(Fit, SharesAddUpAndAreThoseOfTheFewestTriangles) {
  scene::Scene scene = empty_scene();
  scene.budget.flux = 1e-3;
  add(scene, geometry::Cylinder{.radius = 1, .height = 4}, Vec3(0));
  add(scene, geometry::Cylinder{.radius = 0.1, .height = 4}, Vec3(3, 0, 0));
  add(scene, ball(0.2), Vec3(6, 0, 0));
  const std::vector<double> weights = {0.8, 0.05, 0.15};
  const std::vector<double> shares = internal::shares_of(scene, weights);
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += weights[i] * shares[i];
  EXPECT_NEAR(sum, kPartsShare, 1e-9);
  // two cylinders: equal counts for equal relative errors, which go with the power 1/2 of them
  EXPECT_NEAR(shares[1] / shares[0], std::pow(weights[0] / weights[1], 2.0 / 3), 0.35);
  const auto triangles = [&](const std::vector<double>& some) {
    double count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      geometry::TessellationOptions options;
      options.max_error =
          some[i] * *scene.budget.flux * *radius_of_curvature(scene.shapes[i]) / kFluxFactor;
      count += geometry::planned_triangles(scene.shapes[i], options);
    }
    return count;
  };
  const double best = triangles(shares);
  EXPECT_LT(best, 0.9 * triangles({kPartsShare, kPartsShare, kPartsShare}));
  // moving light from one part to another, by an eighth or twice, has no fewer
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      for (const double moved : {0.125, 0.5}) {
        if (i == k) continue;
        std::vector<double> other = shares;
        other[i] *= 1 - moved;
        other[k] += moved * shares[i] * weights[i] / weights[k];
        EXPECT_GE(triangles(other), 0.985 * best) << i << " " << k << " " << moved;
      }
}

// Facet sums of all parts, which do not hide each other here, against closed forms.
TEST(Fit, TheFluxOfTheWholeHolds) {
  scene::Scene scene = empty_scene();
  scene.budget.flux = 0.01;
  std::vector<double> radii = {1, 0.3, 0.1};
  for (int i = 0; i < 60; ++i) radii.push_back(0.002 * std::pow(10, i / 59.0));
  for (std::size_t i = 0; i < radii.size(); ++i)
    add(scene, ball(radii[i]), Vec3(0, 0, 3 * static_cast<double>(i)));
  DiagnosticLog log;
  const auto bytes = compiled(scene, {}, log);
  ASSERT_TRUE(bytes);
  auto model = pan::Model::from_bytes(*bytes, "fit.pan", log);
  ASSERT_TRUE(model && model->check(log));
  EXPECT_LT(model->instances().size(), radii.size());
  double area = 0;
  for (const double r : radii) area += r * r;
  for (const double phase : {0.0, 60.0, 90.0, 120.0}) {
    const double a = phase * kDegree;
    double sum = 0;
    for (const auto& instance : model->instances()) {
      const pan::MeshView view = model->mesh(instance.mesh);
      Mesh mesh;
      for (const auto& p : view.positions) mesh.positions.emplace_back(p.x, p.y, p.z);
      for (const auto& n : view.normals) mesh.normals.emplace_back(n.x, n.y, n.z);
      for (std::size_t i = 0; i < view.indices.size(); i += 3)
        mesh.triangles.push_back({view.indices[i], view.indices[i + 1], view.indices[i + 2]});
      sum += support::seen_by(mesh, Vec3(std::cos(a), std::sin(a), 0), Vec3(1, 0, 0), 6).flux;
    }
    // Lambert's sphere: 2/3·r²·(sin a + (π − a)·cos a)
    const double exact = 2.0 / 3 * area * (std::sin(a) + (kPi - a) * std::cos(a));
    EXPECT_NEAR(sum / exact, 1, *scene.budget.flux) << phase;
  }
}

// A wavy sheet of n × n quads.
MeshShape sheet(int n) {
  auto mesh = std::make_shared<Mesh>();
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
      mesh->positions.push_back({x, y, 0.02 * std::sin(4 * x) * std::cos(3 * y)});
      mesh->normals.push_back(glm::normalize(Vec3(-0.08 * std::cos(4 * x) * std::cos(3 * y),
                                                  0.06 * std::sin(4 * x) * std::sin(3 * y), 1)));
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto at = static_cast<std::uint32_t>(j * (n + 1) + i);
      const auto up = at + static_cast<std::uint32_t>(n) + 1;
      mesh->triangles.push_back({at, at + 1, up + 1});
      mesh->triangles.push_back({at, up + 1, up});
    }
  return mesh;
}

TEST(Fit, MeshesAreSimplifiedWithinTheirTerms) {
  scene::Scene scene = empty_scene();
  const MeshShape full = sheet(48);
  add(scene, full, Vec3(0));
  std::size_t before = 0;
  for (const double nearest : {20.0, 200.0, 2000.0}) {
    scene.budget.nearest = nearest;
    scene.budget.flux = 0.02;
    const Fitted out = fitted(scene);
    ASSERT_EQ(out.report.simplified.size(), 1u) << nearest;
    const Mesh& left = *std::get<MeshShape>(out.scene().shapes[0]);
    EXPECT_LT(left.triangles.size(), full->triangles.size());
    before = left.triangles.size();
    const double tolerance = 0.25 * 1e-4 * nearest;
    const geometry::MeasuredMesh a(*full), b(left);
    EXPECT_LE(geometry::hausdorff_distance(a, b).low, tolerance);
    EXPECT_LE(left.error, tolerance * (1 + 1e-12));
    EXPECT_LE(geometry::hausdorff_distance(a, b).low, left.error);
    const double most = support::seen_by(*full, Vec3(0, 0, 1), Vec3(0, 0, 1), 4).flux;
    for (const double phase : {0.0, 60.0, 90.0}) {
      const Vec3 light(std::sin(phase * kDegree), 0, std::cos(phase * kDegree));
      const double flux = support::seen_by(*full, light, Vec3(0, 0, 1), 4).flux;
      EXPECT_NEAR(support::seen_by(left, light, Vec3(0, 0, 1), 4).flux, flux,
                  0.02 * std::max(flux, most / 10))
          << phase;
    }
    ASSERT_TRUE(out.made_to[0]);
    EXPECT_EQ(out.made_to[0]->reason, pan::layout::ToleranceReason::pixels);
  }
  // what is stored says so, and the same on any number of threads
  DiagnosticLog log;
  const auto one = compiled(scene, {}, log, Job(JobOptions{1, {}}));
  const auto four = compiled(scene, {}, log, Job(JobOptions{4, {}}));
  ASSERT_TRUE(one && four);
  EXPECT_TRUE(*one == *four);
  auto model = pan::Model::from_bytes(*one, "fit.pan", log);
  ASSERT_TRUE(model && model->check(log));
  EXPECT_DOUBLE_EQ(model->mesh_tolerances()[0].tolerance, 0.25 * 1e-4 * 2000);
  EXPECT_GT(model->meshes()[0].error, 0);
  // glossy ones keep their normals: by a quarter of the slope
  scene.materials[0].specular_brdf = materials::CookTorrance{.alpha = 0.01};
  const Fitted glossy = fitted(scene);
  EXPECT_GT(std::get<MeshShape>(glossy.scene().shapes[0])->triangles.size(), before);
  for (const Simplified& mesh : glossy.report.simplified) EXPECT_LE(mesh.normals, 0.0025);
}

TEST(Fit, TexturesAreHalvedWhileAPixelSeesTwoTexels) {
  scene::Scene scene = empty_scene();
  scene::Texture texture{"noise", 256, 256, {}, false};
  std::uint32_t state = 1;
  double light = 0;
  for (std::size_t i = 0; i < std::size_t{256} * 256; ++i) {
    for (int k = 0; k < 3; ++k) {
      state = state * 1664525u + 1013904223u;
      texture.rgba.push_back(static_cast<std::uint8_t>(state >> 24));
      light += image::srgb_decoded(texture.rgba.back()) / (3.0 * 256 * 256);
    }
    texture.rgba.push_back(255);
  }
  scene.textures.push_back(texture);
  const std::size_t at = add(scene, geometry::Plane{}, Vec3(0));
  scene.instances[at].texture = 0;
  // a texel is 3.9 mm
  for (const auto& [pixel, side] :
       {std::pair{0.0078, 256u}, {0.017, 128u}, {0.032, 64u}, {1.0, 2u}, {1e3, 1u}}) {
    scene.budget.nearest = pixel / *scene.budget.ifov;
    scene.budget.flux = 0.05;
    const Fitted out = fitted(scene);
    ASSERT_EQ(out.scene().textures[0].width, side) << pixel;
    ASSERT_EQ(out.scene().textures[0].height, side);
    double mean = 0;
    const auto& rgba = out.scene().textures[0].rgba;
    for (std::size_t i = 0; i < rgba.size(); ++i)
      if (i % 4 != 3) mean += image::srgb_decoded(rgba[i]) / (3.0 * side * side);
    // one code in 255 at the most, where there is but one texel
    EXPECT_NEAR(mean, light, side <= 2 ? 4e-3 : 1e-4) << side;
  }
  // a hole stays where it is
  scene.textures[0].rgba[3] = 0;
  EXPECT_EQ(fitted(scene).scene().textures[0].width, 256u);
}

TEST(Fit, TheNearestPlaceInACorridor) {
  const Vec3 apex(1, 2, 3), axis = glm::normalize(Vec3(1, -2, 0.5));
  const Vec3 side = glm::normalize(glm::cross(axis, Vec3(0, 0, 1)));
  for (const double corridor : {5.0, 30.0, 90.0, 150.0})
    for (const double angle : {0.0, 4.0, 40.0, 100.0, 179.0})
      for (const double distance : {0.5, 4.0, 30.0}) {
        const double nearest = 4, a = angle * kDegree, c = corridor * kDegree;
        const internal::Reach part{apex + distance * (std::cos(a) * axis + std::sin(a) * side),
                                   0.25};
        // in the plane of axis and part: all places of the corridor
        double least = HUGE_VAL;
        for (int i = 0; i <= 500; ++i)
          for (int k = 0; k <= 300; ++k) {
            const double r = nearest + i * 0.08, t = c * k / 300;
            const double x = r * std::cos(t) - distance * std::cos(a);
            const double y = r * std::sin(t) - distance * std::sin(a);
            least = std::min(least, std::hypot(x, y));
          }
        const double expected = std::max(least - 0.25, nearest);
        EXPECT_NEAR(internal::nearest_in_corridor(apex, axis, c, nearest, part), expected, 0.1)
            << corridor << " " << angle << " " << distance;
      }
}

TEST(Fit, AnApproachLetsTheFarEndBeCoarser) {
  scene::Scene scene = empty_scene();
  scene.budget.nearest = 5;
  scene.frames.push_back({"port", 0, Vec3(0, 0, 1), {1, 0, 0, 0}, {}});
  add(scene, ball(1), Vec3(0), "near");
  add(scene, ball(1.5), Vec3(0, 0, -95), "far");
  const auto error = [&](const char* approach) {
    scene.budget.approach = approach;
    Report report;
    DiagnosticLog log;
    const auto path = std::filesystem::temp_directory_path() / "panwright-fit-approach.pan";
    const auto done = compile(scene, {}, path, log);
    EXPECT_TRUE(done);
    std::filesystem::remove(path);
    std::pair<double, double> out;
    for (const PartReport& part : done->parts)
      (part.name == "near" ? out.first : out.second) = part.asked;
    return out;
  };
  const auto anywhere = error(""), along = error("port");
  EXPECT_EQ(anywhere.first, anywhere.second);
  EXPECT_EQ(along.first, anywhere.first);
  // the camera stays 6 m above the origin, the far ball's top is at −93.5
  EXPECT_NEAR(along.second / anywhere.second, 99.5 / 5, 0.6);
}

// Interpolated normals of a shape made to the limit that its gloss sets.
TEST(Fit, NormalsAreWithinAQuarterOfTheSlope) {
  scene::Budget budget;
  budget.nearest = 1e9;
  budget.ifov = 1e-3;
  budget.pixels = 0.25;
  for (const double slope : {0.01, 0.02, 0.1}) {
    const Tolerance tolerance = tolerance_for(budget, ball(1), {}, {{}, {}, slope});
    geometry::TessellationOptions options;
    options.max_error = tolerance.metres;
    DiagnosticLog log;
    for (const geometry::Shape& shape :
         {geometry::Shape(ball(1)), geometry::Shape(geometry::Cylinder{.radius = 1})}) {
      const auto mesh = geometry::tessellated(shape, options, {}, log);
      double largest = 0;
      for (const auto& t : mesh->triangles)
        for (int i = 0; i <= 16; ++i)
          for (int j = 0; i + j <= 16; ++j) {
            const double u = i / 16.0, v = j / 16.0, w = 1 - u - v;
            const Vec3 p =
                w * mesh->positions[t[0]] + u * mesh->positions[t[1]] + v * mesh->positions[t[2]];
            const Vec3 n = glm::normalize(w * mesh->normals[t[0]] + u * mesh->normals[t[1]] +
                                          v * mesh->normals[t[2]]);
            Vec3 exact = glm::normalize(p);
            if (std::holds_alternative<geometry::Cylinder>(shape)) {
              if (std::fabs(n.z) > 0.5) continue;  // an end
              exact = glm::normalize(Vec3(p.x, p.y, 0));
            }
            largest = std::max(largest, angle_between(n, exact));
          }
      // seen along the ray from the middle: on a circle nothing is off; see the docstring for the
      // place along the chord
      EXPECT_LE(largest, slope / 4) << slope;
    }
  }
}

}  // namespace
}  // namespace panwright::compiler::fit_test
