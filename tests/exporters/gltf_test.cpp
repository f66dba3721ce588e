// GLB files written from pans, read back by our own reader.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "compiler/compile.h"
#include "exporters/export.h"
#include "image/srgb.h"
#include "tests/importers/gltf/sample.h"

namespace panwright::exporters::gltf_test {
namespace {

using namespace importers;  // read back by our reader

std::optional<pan::Model> compiled(const scene::Scene& scene) {
  DiagnosticLog log;
  compiler::Options options;
  options.max_error = 1e-2;
  const auto bytes = compiler::compiled(scene, options, log);
  EXPECT_TRUE(bytes) << to_text(log);
  if (!bytes) return std::nullopt;
  auto model = pan::Model::from_bytes(*bytes, "test.pan", log);
  if (!model || !model->check(log)) return std::nullopt;
  return *std::move(model);
}

// The JSON chunk of a GLB file.
nlohmann::json json_of(std::span<const std::byte> glb) {
  std::uint32_t size = 0;
  std::memcpy(&size, glb.data() + 12, 4);
  const char* const text = reinterpret_cast<const char*>(glb.data()) + 20;
  return nlohmann::json::parse(text, text + size);
}

// A sphere, a box twice, mirrored once, with a texture, a coat, a frame and a keypoint.
scene::Scene spacecraft() {
  scene::Scene scene;
  scene.nodes.resize(3);
  scene.nodes[0].name = "root";
  scene.nodes[1].name = "bus/\"A\"";
  scene.nodes[1].parent = 0;
  scene.nodes[1].parent_from_node.translation = {1, 2, 3};
  scene.nodes[1].parent_from_node.rotation = glm::normalize(Quat(0.9, 0.1, -0.3, 0.2));
  scene.nodes[2].name = "mirror";
  scene.nodes[2].parent = 1;
  scene.nodes[2].parent_from_node.scale = {-2, 0.5, 1};
  geometry::Sphere ball;
  ball.radius = 0.7;
  scene.shapes = {ball, geometry::Box{{1, 2, 3}}};
  scene.materials.resize(3);
  scene.materials[0].name = "gold";
  scene.materials[0].specular_brdf = materials::Ggx{0.25, 0.25};
  scene.materials[0].diffuse = Vec3(0);
  scene.materials[0].specular = Vec3(1);
  scene.materials[0].weights = {0, 1, 0};
  scene.materials[0].refract = Vec3(0.2, 0.4, 1.4);
  scene.materials[0].extinction = Vec3(3, 2.5, 1.9);
  scene.materials[1].name = "paint";
  scene.materials[1].coat = materials::Coat{};
  scene.materials[1].emissive = Vec3(3, 0, 1);
  scene.materials[1].weights.z = 1;
  scene.materials[2].name = "panel";
  scene.materials[2].maps.repeat = {2, 3};
  for (auto& material : scene.materials) materials::fit(material);
  scene::Texture texture{"p.png", 2, 1, {255, 0, 0, 255, 0, 255, 10, 255}, false};
  scene.textures.push_back(texture);
  scene.materials[2].maps.albedo = 0;
  scene.instances.resize(3);
  for (std::size_t i = 0; i < 3; ++i) {
    scene.instances[i].node = static_cast<std::int32_t>(i);
    scene.instances[i].shape = i == 0 ? 0 : 1;
    scene.instances[i].material = static_cast<std::int32_t>(i);
  }
  scene.frames.push_back({"camera", 1, {0, 0, 1}, {1, 0, 0, 0}, {}});
  scene.keypoints.push_back({"tip", 2, {0.5, 0, 0}, {}});
  return scene;
}

TEST(GltfExport, ACancelledExportGivesNothing) {
  const auto model = compiled(spacecraft());
  ASSERT_TRUE(model);
  const Job job(JobOptions{});
  ASSERT_TRUE(glb_from(*model, *std::make_unique<DiagnosticLog>(), job));
  job.cancel();
  DiagnosticLog log;
  EXPECT_FALSE(glb_from(*model, log, job));
  EXPECT_TRUE(log.contains(Code("E0001")));
}

TEST(GltfExport, GeometryComesBackBitForBit) {
  const auto model = compiled(spacecraft());
  ASSERT_TRUE(model);
  DiagnosticLog log;
  const auto glb = glb_from(*model, log);
  ASSERT_TRUE(glb) << to_text(log);
  const Loaded out = load({reinterpret_cast<const char*>(glb->data()), glb->size()});
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_EQ(out.log.errors() + out.log.warnings(), 0u) << out.text();
  const Imported& back = *out.imported;
  EXPECT_EQ(scene::check(back.scene), "");
  ASSERT_EQ(back.scene.instances.size(), model->instances().size());
  const std::vector<Mat4> world = model->world_from_nodes();
  const std::vector<Mat4> back_world = scene::world_from_nodes(back.scene);
  EXPECT_TRUE(back.z_up);
  double worst = 0;
  for (std::size_t i = 0; i < back.scene.instances.size(); ++i) {
    // by the names of their nodes
    const scene::Instance& instance = back.scene.instances[i];
    const geometry::Mesh& mesh = mesh_of(back, i);
    std::size_t found = model->instances().size();
    for (std::size_t k = 0; k < model->instances().size(); ++k) {
      std::string name(model->material_name(model->instances()[k].material));
      if (name == back.scene.materials[static_cast<std::size_t>(instance.material)].name) found = k;
    }
    ASSERT_LT(found, model->instances().size());
    const auto& from = model->instances()[found];
    const pan::MeshView view = model->mesh(from.mesh);
    const auto& origin = model->meshes()[from.mesh].origin;
    ASSERT_EQ(mesh.positions.size(), view.positions.size());
    ASSERT_EQ(3 * mesh.triangles.size(), view.indices.size());
    for (std::size_t t = 0; t < view.indices.size(); ++t)
      ASSERT_EQ(mesh.triangles[t / 3][t % 3], view.indices[t]);
    for (std::size_t v = 0; v < view.positions.size(); ++v) {
      const auto& p = view.positions[v];
      const Vec3 place = Vec3(p.x, p.y, p.z) + Vec3(origin[0], origin[1], origin[2]);
      ASSERT_EQ(mesh.positions[v], place);
      const Vec3 wanted = Vec3(world[from.node] * Vec4(place, 1));
      const Vec3 got =
          Vec3(back_world[static_cast<std::size_t>(instance.node)] * Vec4(mesh.positions[v], 1));
      worst = std::max(worst, glm::length(wanted - got));
    }
    EXPECT_EQ(mesh.texcoords.size(), view.texcoords.size());
  }
  EXPECT_LE(worst, 5e-15);  // measured 2e-15
}

// Parts stand where the initial values of their joints have them, and the loss is said.
TEST(GltfExport, JointsStandAtTheirInitialValues) {
  using geometry::JointKind;
  const std::pair<JointKind, std::vector<double>> kinds[] = {
      {JointKind::revolute, {0.7}},
      {JointKind::prismatic, {0.4}},
      {JointKind::ball, {0.3, -1.2, 2}},
      {JointKind::general, {2, -3, 0.5, 0.1, 0.2, 0.3, 4, 5, 6}},
      {JointKind::scale, {2.5}}};
  for (const auto& [kind, value] : kinds) {
    scene::Scene scene = spacecraft();
    scene::Joint joint;
    joint.name = "j";
    joint.node = 2;
    joint.kind = kind;
    joint.axis = glm::normalize(Vec3(1, 2, -2));
    joint.value = value;
    scene::Joint fixed;
    fixed.node = 1;
    fixed.kind = JointKind::fixed;
    scene.joints = {fixed, joint};
    const auto model = compiled(scene);
    ASSERT_TRUE(model);
    DiagnosticLog log;
    const auto glb = glb_from(*model, log);
    ASSERT_TRUE(glb) << to_text(log);
    EXPECT_NE(to_text(log).find("does not keep 2 joints"), std::string::npos) << to_text(log);
    const Loaded out = load({reinterpret_cast<const char*>(glb->data()), glb->size()});
    ASSERT_TRUE(out.imported) << out.text();
    const Mat4 wanted = model->world_from_nodes()[2];
    const auto world = scene::world_from_nodes(out.imported->scene);
    bool found = false;
    for (const scene::Keypoint& point : out.imported->scene.keypoints) {
      if (point.name != "tip") continue;
      found = true;
      const Vec3 tip(wanted * Vec4(0.5, 0, 0, 1));
      const Vec3 back(world[static_cast<std::size_t>(point.node)] * Vec4(point.position, 1));
      EXPECT_LE(glm::length(back - tip), 1e-13 * glm::length(tip)) << geometry::kind_name(kind);
    }
    EXPECT_TRUE(found);
  }
}

// The world position of a keypoint's node.
Vec3 tip_of(const scene::Scene& scene) {
  const auto world = scene::world_from_nodes(scene);
  for (const scene::Keypoint& point : scene.keypoints)
    if (point.name == "tip")
      return Vec3(world[static_cast<std::size_t>(point.node)] * Vec4(point.position, 1));
  ADD_FAILURE() << "no tip";
  return Vec3(0);
}

// Joints out and in again: with the same values, the same places, whatever the axis.
TEST(GltfExport, ArticulationsComeBack) {
  struct Case {
    geometry::JointKind kind;
    Vec3 axis;
    std::vector<double> lower, upper, value, other;
  };
  using geometry::JointKind;
  const std::vector<double> no;
  const Vec3 tilted = glm::normalize(Vec3(1, 2, -2)), down = glm::normalize(Vec3(1e-9, 0, -1));
  const Case cases[] = {
      {JointKind::revolute, {0, 1, 0}, {-1}, {2}, {0.5}, {1.5}},
      {JointKind::revolute, {-1, 0, 0}, {-1}, {2}, {0.5}, {-0.75}},
      {JointKind::revolute, tilted, {-1}, {2}, {0.5}, {1.5}},
      {JointKind::revolute, down, {-1}, {2}, {0.5}, {1.5}},
      {JointKind::continuous, {0, 0, -1}, no, no, {2}, {-3}},
      {JointKind::prismatic, {0, 0, 1}, {0}, {3}, {1}, {2}},
      {JointKind::prismatic, tilted, {0}, {3}, {1}, {2}},
      {JointKind::scale, {0, 1, 0}, {0.5}, {3}, {1.5}, {2}},
      {JointKind::scale, glm::normalize(Vec3(1)), {0.5}, {3}, {1.5}, {2}},
      {JointKind::scale, glm::normalize(Vec3(1, 0, 1)), {0.5}, {3}, {1.5}, {2}},
      {JointKind::ball, {0, 0, 1}, {-3, -1, -3}, {3, 1, 3}, {0.5, 0.4, 0.3}, {-1, 0.8, 2}},
      {JointKind::ball, {0, 0, 1}, no, no, {0.5, 0.4, 0.3}, {-1, 0.8, 2}},
      {JointKind::general,
       {0, 0, 1},
       no,
       no,
       {2, -3, 0.5, 0.1, 0.2, 0.3, 4, 5, 6},
       {1, 1, 2, 1, -0.5, 0.25, -4, 1, 0}},
      {JointKind::general,
       {0, 0, 1},
       {0.5, 0.5, 0.5, -1, -1, -1, -9, -9, -9},
       {3, 3, 3, 1, 1, 1, 9, 9, 9},
       {2, 1, 0.5, 0.1, 0.2, 0.3, 4, 5, 6},
       {1, 1, 2, 1, -0.5, 0.25, -4, 1, 0}}};
  for (const Case& each : cases) {
    scene::Scene scene = spacecraft();
    scene::Joint joint;
    joint.name = "j";
    joint.node = 2;
    joint.kind = each.kind;
    joint.axis = each.axis;
    joint.lower = each.lower;
    joint.upper = each.upper;
    joint.value = each.value;
    scene.joints = {joint};
    const auto model = compiled(scene);
    ASSERT_TRUE(model);
    DiagnosticLog log;
    const auto glb = glb_from(*model, log, {}, {.articulations = true, .joint_values = {}});
    ASSERT_TRUE(glb) << to_text(log);
    const Loaded out = load({reinterpret_cast<const char*>(glb->data()), glb->size()});
    ASSERT_TRUE(out.imported) << out.text();
    EXPECT_EQ(out.log.errors() + out.log.warnings(), 0u) << out.text();
    scene::Scene back = out.imported->scene;
    EXPECT_EQ(scene::check(back), "");
    const auto expected = [&] {
      return Vec3(scene::world_from_nodes(scene)[2] * Vec4(0.5, 0, 0, 1));
    };
    EXPECT_LE(glm::length(tip_of(back) - expected()), 1e-12) << geometry::kind_name(each.kind);
    // another value of the scene's joint, and the same of what came back
    scene.joints[0].value = each.other;
    ASSERT_EQ(back.joints.size(), 1u);
    scene::Joint& same = back.joints[0];
    EXPECT_EQ(same.name, "j");
    EXPECT_EQ(same.kind, each.kind);
    // what pointed against an axis of the node points along it
    const double sign = each.axis == Vec3(-1, 0, 0) || each.axis == Vec3(0, 0, -1) ? -1 : 1;
    same.value = each.other;
    for (double& value : same.value) value *= sign;
    ASSERT_EQ(same.lower.size(), each.lower.size());
    for (std::size_t k = 0; k < same.lower.size(); ++k) {
      EXPECT_NEAR(same.lower[k], sign > 0 ? each.lower[k] : -each.upper[k], 1e-15);
      EXPECT_NEAR(same.upper[k], sign > 0 ? each.upper[k] : -each.lower[k], 1e-15);
    }
    EXPECT_LE(glm::length(tip_of(back) - expected()), 1e-12) << geometry::kind_name(each.kind);
  }
}

// Joints of one node, a chain of them, and stages that somebody else named.
TEST(GltfExport, ChainsOfJointsKeepTheirNamesAndKinds) {
  using geometry::JointKind;
  scene::Scene scene = spacecraft();
  const auto add = [&](const char* name, std::int32_t node, JointKind kind, const Vec3& axis) {
    scene::Joint joint;
    joint.name = name;
    joint.node = node;
    joint.kind = kind;
    joint.axis = axis;
    if (kind == JointKind::prismatic || kind == JointKind::revolute)
      joint.lower = {-1}, joint.upper = {2};
    scene.joints.push_back(joint);
  };
  add("boom", 1, JointKind::prismatic, glm::normalize(Vec3(1, 2, 3)));
  add("boom turn", 1, JointKind::revolute, {0, 1, 0});
  add("socket", 1, JointKind::ball, {0, 0, 1});
  add("arm/free", 2, JointKind::general, {0, 0, 1});
  add("arm/wheel", 2, JointKind::continuous, {1, 0, 0});
  const auto model = compiled(scene);
  ASSERT_TRUE(model);
  DiagnosticLog log;
  const auto glb = glb_from(*model, log, {}, {.articulations = true, .joint_values = {}});
  ASSERT_TRUE(glb) << to_text(log);
  const Loaded out = load({reinterpret_cast<const char*>(glb->data()), glb->size()});
  ASSERT_TRUE(out.imported) << out.text();
  const scene::Scene& back = out.imported->scene;
  EXPECT_EQ(scene::check(back), "");
  std::map<std::string, JointKind> kinds, wanted;
  for (const scene::Joint& joint : back.joints) kinds[joint.name] = joint.kind;
  for (const scene::Joint& joint : scene.joints) wanted[joint.name] = joint.kind;
  EXPECT_EQ(kinds, wanted);
  EXPECT_EQ(back.joints.size(), scene.joints.size());
}

TEST(GltfExport, NamesMaterialsAndPointsComeBack) {
  const auto model = compiled(spacecraft());
  ASSERT_TRUE(model);
  DiagnosticLog log;
  const auto glb = glb_from(*model, log);
  ASSERT_TRUE(glb);
  EXPECT_TRUE(log.contains(Code("W6402"))) << to_text(log);  // a complex index
  const Loaded out = load({reinterpret_cast<const char*>(glb->data()), glb->size()});
  ASSERT_TRUE(out.imported) << out.text();
  std::set<std::string> names;
  for (const auto& node : out.imported->scene.nodes) names.insert(node.name);
  EXPECT_EQ(names, (std::set<std::string>{"root", "bus_\"A\"", "mirror"}));
  const scene::Scene& tree = out.imported->scene;
  ASSERT_EQ(tree.nodes.size(), model->nodes().size());
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    EXPECT_EQ(tree.nodes[i].parent, model->nodes()[i].parent);
    EXPECT_EQ(tree.nodes[i].parent_from_node, spacecraft().nodes[i].parent_from_node);
  }
  ASSERT_EQ(tree.frames.size(), 1u);
  EXPECT_EQ(tree.frames[0].name, "camera");
  ASSERT_EQ(tree.keypoints.size(), 1u);
  EXPECT_EQ(tree.keypoints[0].name, "tip");
  for (std::size_t i = 0; i < out.imported->materials.size(); ++i) {
    const CadMaterial& cad = out.imported->materials[i];
    const materials::Material& material = out.imported->scene.materials[i];
    if (cad.name == "gold") {
      // F at normal incidence of these n and k
      EXPECT_NEAR(cad.base_color.x, (0.64 + 9) / (1.44 + 9), 1e-6);
      EXPECT_EQ(cad.metallic, 1);
      EXPECT_NEAR(cad.roughness, 0.5, 1e-7);
    } else if (cad.name == "paint") {
      // below n = 1.5 a white sky passes K = (1 − 0.0918)/1.5² of a plate's light: an albedo of 0.8
      // looks like 0.8·K/(1 − 0.8·(1 − K)); measured 0.0023 beside it, by what leaves at 37 degrees
      EXPECT_NEAR(cad.base_color.x, 0.6175, 4e-3);
      EXPECT_LE(glm::length(material.diffuse - Vec3(0.8)), 1e-4);
      EXPECT_EQ(cad.metallic, 0);
      EXPECT_EQ(material.specular_model(), materials::SpecularModel::none);
      EXPECT_TRUE(material.coat);
      EXPECT_LE(glm::length(material.emissive - Vec3(3, 0, 1)), 1e-6);
    } else if (cad.name == "panel") {
      ASSERT_GE(material.maps.albedo, 0);
      const scene::Texture& texture =
          out.imported->scene.textures[static_cast<std::size_t>(material.maps.albedo)];
      EXPECT_EQ(texture.rgba, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 10, 255}));
    }
  }
}

// The largest difference of a texture's texels, decoded and times a factor, to colours.
double apart(const scene::Texture& texture, const Vec3& factor, const std::vector<Vec3>& wanted) {
  double worst = 0;
  EXPECT_EQ(texture.rgba.size(), 4 * wanted.size());
  for (std::size_t i = 0; i < std::min(wanted.size(), texture.rgba.size() / 4); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto c = static_cast<int>(k);
      worst = std::max(worst, std::fabs(image::srgb_decoded(texture.rgba[4 * i + k]) * factor[c] -
                                        wanted[i][c]));
    }
  return worst;
}

// A reflectance map without diffuse light is the colour of a metal; with it, the two are a mixture
// of dielectric and metal.
TEST(GltfExport, ReflectanceMapsAreColorsOfMetalsOrMixtures) {
  scene::Scene scene = spacecraft();
  const std::vector<std::uint8_t> metal = {255, 0, 0, 255, 0, 255, 10, 255};
  // 0.04·½ + ½·(0.6, 0.5, 0.2) and a dielectric
  const std::vector<std::uint8_t> mixed = {
      image::srgb_code(0.32), image::srgb_code(0.27), image::srgb_code(0.12), 255,
      image::srgb_code(0.04), image::srgb_code(0.04), image::srgb_code(0.04), 255};
  const std::vector<std::uint8_t> below = {
      image::srgb_code(0.6), image::srgb_code(0.5), image::srgb_code(0.2), 255,
      image::srgb_code(0.9), image::srgb_code(0.2), image::srgb_code(0.4), 255};
  scene.materials[2] = scene.materials[0];
  scene.materials[2].name = "panel";
  scene.materials[2].maps.reflectance = 0;
  scene.materials[2].maps.repeat = {2, 3};
  scene.textures.push_back({"d.png", 2, 1, below, false});
  for (const bool diffuse : {false, true}) {
    scene.textures[0].rgba = diffuse ? mixed : metal;
    if (diffuse) {
      scene.materials[2].maps.albedo = 1;
      scene.materials[2].diffuse = Vec3(0.48);
      scene.materials[2].weights.x = 1;
    }
    materials::fit(scene.materials[2]);
    const auto model = compiled(scene);
    ASSERT_TRUE(model);
    DiagnosticLog log;
    const auto glb = glb_from(*model, log);
    ASSERT_TRUE(glb);
    const Loaded out = load({reinterpret_cast<const char*>(glb->data()), glb->size()});
    ASSERT_TRUE(out.imported) << out.text();
    const scene::Scene& back = out.imported->scene;
    bool found = false;
    for (std::size_t i = 0; i < out.imported->materials.size(); ++i) {
      if (out.imported->materials[i].name != "panel") continue;
      found = true;
      const materials::Material& material = back.materials[i];
      ASSERT_GE(material.maps.reflectance, 0);
      const scene::Texture& shine =
          back.textures[static_cast<std::size_t>(material.maps.reflectance)];
      if (!diffuse) {
        EXPECT_EQ(out.imported->materials[i].metallic, 1);
        EXPECT_EQ(out.imported->materials[i].base_color, Vec3(1));
        EXPECT_EQ(shine.rgba, metal);
        continue;
      }
      ASSERT_GE(material.maps.albedo, 0);
      // measured 0.0015 and 0.0040: a code is up to 0.009 wide
      EXPECT_LE(apart(shine, Vec3(1), {{0.32, 0.27, 0.12}, Vec3(0.04)}), 5e-3);
      EXPECT_LE(apart(back.textures[static_cast<std::size_t>(material.maps.albedo)],
                      material.diffuse, {0.48 * Vec3(0.6, 0.5, 0.2), 0.48 * Vec3(0.9, 0.2, 0.4)}),
                5e-3);
    }
    EXPECT_TRUE(found);
  }
}

// What a material loses is said as a share of its light: here that between Lommel and Seeliger's
// BRDF and the Lambert's of the same albedo, summed over a grid of lights.
TEST(GltfExport, LossesAreSharesOfTheLight) {
  scene::Scene scene = spacecraft();
  scene.materials[0] = {};
  scene.materials[0].name = "regolith";
  scene.materials[0].diffuse_brdf = materials::LommelSeeliger{0.4};
  scene.materials[0].diffuse = Vec3(1);
  materials::fit(scene.materials[0]);
  const auto model = compiled(scene);
  ASSERT_TRUE(model);
  DiagnosticLog log;
  ASSERT_TRUE(glb_from(*model, log));
  const auto ours = [](double l, double v) { return 0.1 / kPi / (l + v); };
  constexpr int kSteps = 2000;
  const auto over_cosines = [](auto f) {
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) sum += f((i + 0.5) / kSteps) / kSteps;
    return sum;
  };
  const double albedo = over_cosines([&](double v) {
    return 2 * v * over_cosines([&](double l) { return 2 * kPi * l * ours(l, v); });
  });
  double share = 0;
  for (const double v : {0.95, 0.5}) {
    const double all = over_cosines([&](double l) { return l * ours(l, v); });
    const double off =
        over_cosines([&](double l) { return l * std::fabs(ours(l, v) - albedo / kPi); });
    share = std::max(share, off / all);
  }
  const std::string text = to_text(log);
  const std::string before = "other than Lambert's: ";
  const std::size_t at = text.find(before);
  ASSERT_NE(at, std::string::npos) << text;
  // measured 0.0027 beside 0.307, and two digits are printed
  EXPECT_NEAR(std::stod(text.substr(at + before.size())) / 100, share, 0.008) << text;
}

// The pattern of solar cells becomes a texture whose mean is that of its parts by their areas.
TEST(GltfExport, SolarCellsAreDrawn) {
  scene::Scene scene = spacecraft();
  materials::Material& panel = scene.materials[1];
  panel = {};
  panel.name = "panel";
  panel.diffuse = Vec3(0.1);
  materials::Cells cells;
  cells.count = {6, 4};
  cells.gap = {0.1, 0.1};
  cells.fingers = 2;
  cells.finger_width = 0.1;
  cells.gap_color = Vec3(0.5, 0.4, 0.3);
  cells.finger_color = Vec3(0.6);
  panel.cells = cells;
  materials::fit(panel);
  scene.materials[2] = scene.materials[0];
  const auto model = compiled(scene);
  ASSERT_TRUE(model);
  DiagnosticLog log;
  const auto glb = glb_from(*model, log);
  ASSERT_TRUE(glb);
  EXPECT_EQ(to_text(log).find("solar cells"), std::string::npos) << to_text(log);
  const Loaded out = load({reinterpret_cast<const char*>(glb->data()), glb->size()});
  ASSERT_TRUE(out.imported) << out.text();
  const materials::Material* back = nullptr;
  for (const materials::Material& material : out.imported->scene.materials)
    if (material.name == "panel") back = &material;
  ASSERT_TRUE(back && back->maps.albedo >= 0);
  const scene::Texture& texture =
      out.imported->scene.textures[static_cast<std::size_t>(back->maps.albedo)];
  const double gap = 1 - 0.9 * 0.9, finger = 0.81 * 0.1, cell = 0.81 - finger;
  for (int c = 0; c < 3; ++c) {
    double sum = 0;
    for (std::size_t i = static_cast<std::size_t>(c); i < texture.rgba.size(); i += 4)
      sum += image::srgb_decoded(texture.rgba[i]) * back->diffuse[c];
    const double found = 4 * sum / static_cast<double>(texture.rgba.size());
    // measured 8e-4, by codes
    EXPECT_NEAR(found, cell * 0.1 + finger * 0.6 + gap * cells.gap_color[c], 1e-3);
  }
}

// Back faces are drawn where the model draws them: of open meshes and cut-outs.
TEST(GltfExport, OpenMeshesAndCutoutsHaveTwoSides) {
  scene::Scene scene = spacecraft();
  scene.materials[2].maps.cutout = 0;
  scene.shapes.push_back(geometry::Plane{});
  scene.instances[1].shape = 2;
  const auto model = compiled(scene);
  ASSERT_TRUE(model);
  DiagnosticLog log;
  const auto glb = glb_from(*model, log);
  ASSERT_TRUE(glb);
  const auto root = json_of(*glb);
  for (const auto& material : root["materials"]) {
    const std::string name = material["name"];
    EXPECT_EQ(material.value("doubleSided", false), name != "gold") << name;
    EXPECT_EQ(material.value("alphaMode", "OPAQUE"), name == "panel" ? "MASK" : "OPAQUE") << name;
  }
}

// A surface with two materials becomes two that are seen from one side each; where one of them is
// on both sides of another surface too, it is written once more.
TEST(GltfExport, BacksAreSurfacesOfTheirOwn) {
  scene::Scene scene = spacecraft();
  scene.shapes.push_back(geometry::Plane{});
  scene.instances.resize(2);
  for (scene::Instance& one : scene.instances) {
    one.shape = 2;
    one.material = 1;
    one.texture = scene::kNone;
    one.mapping = scene::Mapping::texcoords;
  }
  scene.decals.clear();
  scene.instances[0].back = 0;
  const auto model = compiled(scene);
  ASSERT_TRUE(model);
  DiagnosticLog log;
  const auto glb = glb_from(*model, log);
  ASSERT_TRUE(glb);
  const auto root = json_of(*glb);
  std::multiset<std::pair<std::string, bool>> materials;
  for (const auto& material : root["materials"])
    materials.emplace(material["name"], material.value("doubleSided", false));
  EXPECT_EQ(materials, (std::multiset<std::pair<std::string, bool>>{
                           {"gold", false}, {"paint", false}, {"paint", true}}));
  const Loaded out = load({reinterpret_cast<const char*>(glb->data()), glb->size()});
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_EQ(scene::check(out.imported->scene), "");
  // and comes back as one
  const scene::Scene& scene_back = out.imported->scene;
  ASSERT_EQ(scene_back.instances.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const scene::Instance& one = scene_back.instances[i];
    EXPECT_EQ(scene_back.materials[static_cast<std::size_t>(one.material)].name, "paint");
    EXPECT_GT(mesh_of(*out.imported, i).normals[0].z, 0);
  }
  const std::int32_t first = scene_back.instances[0].back, second = scene_back.instances[1].back;
  ASSERT_NE(first == scene::kNone, second == scene::kNone);
  EXPECT_EQ(scene_back.materials[static_cast<std::size_t>(std::max(first, second))].name, "gold");
}

TEST(GltfExport, SameModelSameBytes) {
  const auto model = compiled(spacecraft());
  ASSERT_TRUE(model);
  DiagnosticLog log;
  const auto first = glb_from(*model, log), second = glb_from(*model, log);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(*first, *second);
}

}  // namespace
}  // namespace panwright::exporters::gltf_test
