// What the reference does by itself, against what the preview and the world do for the same: each
// pair is two texts of one rule.
#include <random>

#include "preview/model/map_levels.h"
#include "preview/model/tangents.h"
#include "preview/reference/internal/tangents.h"
#include "preview/reference/internal/view_rays.h"
#include "reference_models.h"
#include "trace/placement.h"
#include "trace/texture.h"
#include "world/evaluation.h"

namespace panwright::preview::independence_test {
namespace {

using namespace testing_support;

double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

TEST(ReferenceIndependence, TexturesAreDecodedAlike) {
  std::mt19937_64 random(1);
  constexpr std::uint32_t kWidth = 24, kHeight = 16;
  std::vector<std::uint8_t> rgba(4 * kWidth * kHeight);
  for (std::uint8_t& code : rgba) code = static_cast<std::uint8_t>(random());
  const float threshold = 51 / 255.0f;
  double worst = 0, worst_normal = 0;
  for (const bool linear : {false, true}) {
    const trace::Texture texture(rgba, kWidth, kHeight, linear);
    const auto level = [&](TextureRole role) {
      return map_levels(rgba, kWidth, kHeight, linear, role, threshold).front();
    };
    const TextureLevel color = level(TextureRole::color);
    const TextureLevel premultiplied = level(TextureRole::premultiplied);
    const TextureLevel normal = level(TextureRole::normal);
    const TextureLevel rough = level(TextureRole::roughness);
    const TextureLevel cutout = level(TextureRole::cutout);
    for (std::uint32_t y = 0; y < kHeight; ++y)
      for (std::uint32_t x = 0; x < kWidth; ++x) {
        // another repeat of the same texel
        const Vec2 at((x + 0.5) / kWidth + 3, (y + 0.5) / kHeight - 2);
        const std::size_t i = 4 * (std::size_t{y} * kWidth + x);
        const auto off = [&](double value, float theirs) {
          worst = std::max(worst, std::fabs(value - static_cast<double>(theirs)));
        };
        for (int k = 0; k < 3; ++k) {
          const auto c = static_cast<std::size_t>(k);
          off(texture.color(at)[k], color.rgba[i + c]);
          off(texture.premultiplied(at)[k], premultiplied.rgba[i + c]);
          off(texture.clamped_premultiplied(at - Vec2(3, -2))[k], premultiplied.rgba[i + c]);
          worst_normal =
              std::max(worst_normal, std::fabs(texture.normal(at)[k] - normal.rgba[i + c]));
        }
        off(texture.premultiplied(at).w, premultiplied.rgba[i + 3]);
        off(texture.red(at), rough.rgba[i]);
        off(texture.alpha(at) - static_cast<double>(threshold), cutout.rgba[i]);
      }
  }
  printf("texels: worst %.1e, normals %.1e\n", worst, worst_normal);
  EXPECT_LE(worst, 1.5e-7);  // measured 6e-8: theirs are floats
  // codes near the middle make short vectors, which a float of the code decides to 1e-7 of 0.1
  EXPECT_LE(worst_normal, 2e-6);  // measured 9e-7
}

// A texel at the threshold is there, in both, and between equal texels nothing is rounded away.
TEST(ReferenceIndependence, AlphaAtTheThresholdIsThere) {
  for (int code = 0; code < 256; ++code) {
    const std::vector<std::uint8_t> rgba(4 * 4, static_cast<std::uint8_t>(code));
    const float threshold = static_cast<float>(code) / 255;
    const trace::Texture texture(rgba, 2, 2, true);
    const TextureLevel cutout =
        map_levels(rgba, 2, 2, true, TextureRole::cutout, threshold).front();
    for (const Vec2& at : {Vec2(0.25), Vec2(0.4, 0.77), Vec2(-0.1, 13.3)})
      EXPECT_GE(texture.alpha(at), static_cast<double>(threshold)) << code;
    EXPECT_GE(cutout.rgba[0], 0) << code;
  }
}

TEST(ReferenceIndependence, TangentsAreAlike) {
  geometry::Mesh skewed = plate(2, 1);
  // a mirrored copy beside it, and a triangle without an area in the texture
  for (std::size_t i = 0; i < 4; ++i) {
    skewed.positions.push_back(skewed.positions[i] + Vec3(2, 0, 0.5 * static_cast<double>(i % 2)));
    skewed.normals.push_back(glm::normalize(Vec3(0.1, 0.2, 1)));
    skewed.texcoords.push_back(
        Vec2(-skewed.texcoords[i].x + 0.3 * skewed.texcoords[i].y, 1.7 * skewed.texcoords[i].y));
  }
  skewed.triangles.push_back({4, 5, 6});
  skewed.triangles.push_back({4, 6, 7});
  double worst = 0;
  for (const geometry::Mesh& mesh : {sphere(20, 30, true), skewed}) {
    const pan::Model model = model_of(single(mesh, lambert(1)));
    const pan::MeshView view = model.mesh(0);
    const Tangents theirs = tangents(view);
    const reference::TangentField ours(view);
    for (std::uint32_t triangle = 0; triangle < view.indices.size() / 3; ++triangle)
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3 weight(0);
        weight[static_cast<int>(k)] = 1;
        const std::size_t corner = 3 * std::size_t{triangle} + k;
        const std::size_t at =
            4 * (theirs.indices.empty() ? view.indices[corner] : theirs.indices[corner]);
        const auto [tangent, handed] = ours(triangle, weight);
        const float* t = &theirs.tangents[at];
        worst = std::max(worst, glm::length(tangent - Vec3(t[0], t[1], t[2])));
        EXPECT_EQ(handed, static_cast<double>(t[3])) << triangle;
      }
  }
  printf("tangents: worst %.1e\n", worst);
  EXPECT_LE(worst, 3e-7);  // measured 4e-8: theirs are floats
}

// The solid angle of [0, x] × [0, y] on the plane at distance 1, in long double.
long double corner_solid_angle(long double x, long double y) {
  return std::atan2(x * y, std::sqrt(1 + x * x + y * y));
}

TEST(ReferenceIndependence, PixelsAreAlike) {
  std::mt19937_64 random(2);
  double ray_off = 0, weight_off = 0, world_off = 0;
  for (int i = 0; i < 2000; ++i) {
    world::Camera camera;
    camera.width = 100;
    camera.height = 80;
    const double focal = std::pow(10, 7 * uniform(random));
    camera.focal = Vec2(focal, focal * (0.5 + uniform(random)));
    camera.principal = Vec2(100 * uniform(random), 80 * uniform(random));
    camera.position = Vec3(uniform(random), uniform(random), uniform(random));
    camera.world_from_camera = glm::normalize(
        Quat(uniform(random), uniform(random) - 0.5, uniform(random) - 0.5, uniform(random)));
    camera.projection = i % 2 ? world::Projection::perspective : world::Projection::orthographic;
    const Vec2 place(100 * uniform(random), 80 * uniform(random));
    const geometry::Ray theirs = world::pixel_ray(camera, place);
    const geometry::Ray ours = *reference::view_ray(camera, place);
    const trace::RigidFrame frame = trace::frame_of({camera.position, camera.world_from_camera});
    ray_off = std::max(
        {ray_off, glm::length(frame.world_from * ours.direction - theirs.direction),
         glm::length(frame.world_from * ours.origin + frame.position - theirs.origin) / 100});
    const auto x = static_cast<std::uint32_t>(place.x), y = static_cast<std::uint32_t>(place.y);
    const double weight = reference::pixel_weight(camera, x, y);
    if (i % 2 == 0) {
      EXPECT_DOUBLE_EQ(weight, pixel_area(camera));
      continue;
    }
    world_off = std::max(world_off, std::fabs(pixel_solid_angle(camera, x, y) / weight - 1));
    // differences of corners are worth something in long double where pixels are wide
    if (focal > 50) continue;
    const auto at = [](double pixel, double principal, double f) {
      return (static_cast<long double>(pixel) - principal) / f;
    };
    const long double x0 = at(x, camera.principal.x, camera.focal.x),
                      x1 = at(x + 1.0, camera.principal.x, camera.focal.x),
                      y0 = at(y, camera.principal.y, camera.focal.y),
                      y1 = at(y + 1.0, camera.principal.y, camera.focal.y);
    const long double exact = corner_solid_angle(x1, y1) - corner_solid_angle(x0, y1) -
                              corner_solid_angle(x1, y0) + corner_solid_angle(x0, y0);
    weight_off = std::max(weight_off, std::fabs(static_cast<double>(weight / exact - 1)));
  }
  printf("rays %.1e, solid angles %.1e, the world's %.1e\n", ray_off, weight_off, world_off);
  EXPECT_LE(ray_off, 3e-15);  // measured 1.3e-15
  EXPECT_LE(weight_off, 1e-12);
  // its differences of corners cancel where pixels are wide and far from the axis: measured 6e-11
  EXPECT_LE(world_off, 1e-9);
}

TEST(ReferenceIndependence, NodesStandAlike) {
  std::mt19937_64 random(3);
  const auto real = [&](double low, double high) { return low + (high - low) * uniform(random); };
  const auto turn = [&] {
    return glm::normalize(Quat(real(-1, 1), real(-1, 1), real(-1, 1), real(-1, 1)));
  };
  pan::Contents contents = single(box({1, 1, 1}), lambert(1));
  for (int i = 1; i < 60; ++i)
    contents.nodes.push_back({"n", static_cast<std::int32_t>(random() % contents.nodes.size()),
                              Vec3(real(-2, 2), real(-2, 2), real(-2, 2)), turn(),
                              Vec3(real(0.5, 2), real(-2, -0.5), real(0.5, 2))});
  const world::ModelPtr model = panwright::testing_support::shared(model_of(contents));
  world::World world;
  DiagnosticLog log;
  ASSERT_TRUE(world.add("a", model, log));
  for (std::uint32_t node = 0; node < 60; node += 3) {
    world.set_node_transform(0, node,
                             world::NodeTransform{{real(-2, 2), 0, 1}, turn(), {1, 2, -1}});
    if (node % 4 == 1) world.set_node_visible(0, node, false);
  }
  const world::EvaluatedInstance theirs = world::evaluated(world[0]);
  const trace::PlacedNodes ours = trace::placed_nodes(world[0]);
  double worst = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    const Mat4& m = theirs.model_from_nodes[i];
    double size = 1;
    for (int column = 0; column < 4; ++column) size = std::max(size, glm::length(Vec3(m[column])));
    for (int column = 0; column < 3; ++column)
      worst = std::max(
          worst, glm::length(ours.model_from_node[i].linear[column] - Vec3(m[column])) / size);
    worst = std::max(worst, glm::length(ours.model_from_node[i].offset - Vec3(m[3])) / size);
    EXPECT_EQ(ours.visible[i], theirs.node_visible[i]);
  }
  printf("nodes: worst %.1e of their size\n", worst);
  EXPECT_LE(worst, 2e-14);
}

// Joints of every kind, some that follow others, initial values and values of the world: nodes as
// the preview's.
TEST(ReferenceIndependence, JointsMoveNodesAlike) {
  std::mt19937_64 random(4);
  const auto real = [&](double low, double high) { return low + (high - low) * uniform(random); };
  const auto turn = [&] {
    return glm::normalize(Quat(real(-1, 1), real(-1, 1), real(-1, 1), real(-1, 1)));
  };
  using geometry::JointKind;
  pan::Contents contents = single(box({1, 1, 1}), lambert(1));
  for (std::uint32_t i = 1; i < 43; ++i) {
    contents.nodes.push_back({"n", static_cast<std::int32_t>(random() % contents.nodes.size()),
                              Vec3(real(-2, 2), real(-2, 2), real(-2, 2)), turn(),
                              Vec3(real(0.5, 2), real(-2, -0.5), real(0.5, 2))});
    pan::JointContent joint;
    joint.name = "j" + std::to_string(i);
    joint.node = i;
    joint.joint.kind = static_cast<JointKind>(i % geometry::kJointKinds);
    joint.joint.axis = joint.joint.kind == JointKind::scale
                           ? Vec3(1, 0, 0)
                           : glm::normalize(Vec3(real(-1, 1), real(-1, 1), real(0.1, 1)));
    joint.value = geometry::rest_values(joint.joint.kind);
    for (std::size_t k = 0; k < geometry::value_count(joint.joint.kind); ++k)
      joint.value[k] += real(-0.4, 0.4);
    if (i > 30 && geometry::can_mimic(joint.joint)) {
      joint.joint.mimic = static_cast<std::int32_t>(i) - 8;  // of the same kind
      joint.joint.multiplier = 0.5;
      joint.joint.offset = 0.2;
      joint.value = geometry::rest_values(joint.joint.kind);
    }
    contents.joints.push_back(joint);
  }
  const world::ModelPtr model = panwright::testing_support::shared(model_of(contents));
  world::World world;
  DiagnosticLog log;
  ASSERT_TRUE(world.add("a", model, log));
  double worst = 0;
  for (int run = 0; run < 20; ++run) {
    for (std::uint32_t j = 0; run > 0 && j < 20; ++j) {
      geometry::JointValues values = contents.joints[j].value;
      for (std::size_t k = 0; k < geometry::value_count(contents.joints[j].joint.kind); ++k)
        values[k] += real(-0.5, 0.5);
      world.set_joint(0, j, values);
    }
    const world::EvaluatedInstance theirs = world::evaluated(world[0]);
    const trace::PlacedNodes ours = trace::placed_nodes(world[0]);
    for (std::size_t i = 0; i < contents.nodes.size(); ++i) {
      const Mat4& m = theirs.model_from_nodes[i];
      double size = 1;
      for (int column = 0; column < 4; ++column)
        size = std::max(size, glm::length(Vec3(m[column])));
      for (int column = 0; column < 3; ++column)
        worst = std::max(
            worst, glm::length(ours.model_from_node[i].linear[column] - Vec3(m[column])) / size);
      worst = std::max(worst, glm::length(ours.model_from_node[i].offset - Vec3(m[3])) / size);
    }
  }
  printf("joints: worst %.1e of their size\n", worst);
  EXPECT_LE(worst, 2e-14);
}

// A bar along x from the origin, a quarter turn about z: along y.
TEST(ReferenceIndependence, AJointTurnsWhatIsDrawn) {
  pan::Contents contents = single(box({1, 0.2, 0.2}), lambert(1));
  contents.nodes.push_back({"bar", 0, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.nodes.push_back({"place", 1, Vec3(0.5, 0, 0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.instances[0].node = 2;
  pan::JointContent hinge;
  hinge.name = "hinge";
  hinge.node = 1;
  hinge.joint.kind = geometry::JointKind::revolute;
  contents.joints = {hinge};
  world::World bar;
  DiagnosticLog log;
  ASSERT_TRUE(bar.add("a", panwright::testing_support::shared(model_of(contents)), log));
  world::Camera camera = looking_from({0, 0, 1}, 5, 0.5, 40).camera;
  ReferenceOptions options;
  options.samples = 1;
  options.ground_truth = true;
  for (const double angle : {0.0, 90.0}) {
    bar.set_joint(0, 0, geometry::JointValues{angle * kDegree});
    const auto drawn = Reference().render(bar, camera, options, log);
    ASSERT_TRUE(drawn) << to_text(log);
    const Vec3 end = angle == 0 ? Vec3(0.9, 0, 0) : Vec3(0, 0.9, 0);
    const Vec3 other = angle == 0 ? Vec3(0, 0.9, 0) : Vec3(0.9, 0, 0);
    const auto id_at = [&](const Vec3& p) {
      const Vec3 c = glm::conjugate(camera.world_from_camera) * (p - camera.position);
      const auto x = static_cast<std::size_t>(camera.principal.x + camera.focal.x * c.x / c.z);
      const auto y = static_cast<std::size_t>(camera.principal.y + camera.focal.y * c.y / c.z);
      return drawn->image.node_id[y * drawn->image.width + x];
    };
    EXPECT_EQ(id_at(end), 3u) << angle;
    EXPECT_EQ(id_at(other), 0u) << angle;
  }
}

}  // namespace
}  // namespace panwright::preview::independence_test
