// Hand-made files of every form of accessor, primitive and node, against answers in closed form.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/importers/gltf/sample.h"

namespace panwright::importers::reader_test {
namespace {

using nlohmann::json;

double distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  if (a.size() != b.size()) return INFINITY;
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, glm::length(a[i] - b[i]));
  return worst;
}

const std::vector<Vec3> kTriangle = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

// A quantised triangle whose numbers are those of `list`, read at `stride` bytes.
template <class T>
Loaded quantised(const std::vector<T>& list, int component, bool normalised) {
  Sample sample;
  sample.json["extensionsUsed"] = sample.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  std::vector<T> padded;  // every vertex at a multiple of 4 bytes
  for (std::size_t i = 0; i < list.size(); ++i) {
    padded.push_back(list[i]);
    if (i % 3 == 2) padded.push_back(T(99));
  }
  const int view = sample.view(padded, 4 * static_cast<int>(sizeof(T)));
  const int accessor = sample.accessor(view, component, list.size() / 3, "VEC3", normalised);
  sample.json["accessors"][0]["min"] = sample.json["accessors"][0]["max"] = {0, 0, 0};
  sample.add_mesh({{"attributes", {{"POSITION", accessor}}}});
  return load(sample.glb());
}

TEST(GltfReader, EveryComponentTypeAndNormalisation) {
  // c/127 clamped at −1, c/255, c/32767, c/65535: glTF 2.0, 3.6.2.2
  const std::vector<Vec3> integers = {{0, 5, 100}, {127, -1, 3}, {-128, 7, 9}};
  std::vector<Vec3> scaled;
  for (const Vec3& p : integers) scaled.push_back(glm::max(p / 127.0, Vec3(-1)));
  const std::vector<std::int8_t> bytes = {0, 5, 100, 127, -1, 3, -128, 7, 9};
  auto out = quantised(bytes, kByte, false);
  ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
  EXPECT_EQ(mesh_of(*out.imported).positions, integers);
  out = quantised(bytes, kByte, true);
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_LE(distance(mesh_of(*out.imported).positions, scaled), 1.2e-16);  // measured 1.1e-16

  const std::vector<std::uint8_t> small = {0, 51, 255, 255, 0, 0, 0, 255, 102};
  out = quantised(small, kUnsignedByte, true);
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_LE(distance(mesh_of(*out.imported).positions, {{0, 0.2, 1}, {1, 0, 0}, {0, 1, 0.4}}),
            1e-16);
  const std::vector<std::int16_t> shorts = {0, 32767, -32768, 32767, 0, 0, 0, 16384, -1};
  out = quantised(shorts, kShort, true);
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_LE(distance(mesh_of(*out.imported).positions,
                     {{0, 1, -1}, {1, 0, 0}, {0, 16384.0 / 32767, -1.0 / 32767}}),
            1e-16);
  const std::vector<std::uint16_t> words = {0, 65535, 13107, 65535, 0, 0, 0, 1, 2};
  out = quantised(words, kUnsignedShort, true);
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_LE(distance(mesh_of(*out.imported).positions,
                     {{0, 1, 0.2}, {1, 0, 0}, {0, 1.0 / 65535, 2.0 / 65535}}),
            1e-16);
  out = quantised(words, kUnsignedShort, false);
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_EQ(mesh_of(*out.imported).positions[0], Vec3(0, 65535, 13107));
}

TEST(GltfReader, SparseValuesLieOverAViewOrOverZeros) {
  for (const bool over_zeros : {true, false}) {
    Sample sample = triangle();
    const int places = sample.view(std::vector<std::uint16_t>{1, 2});
    const int values = sample.view(std::vector<float>{7, 8, 9, -1, -2, -3});
    json& accessor = sample.json["accessors"][0];
    if (over_zeros) accessor.erase("bufferView");
    accessor["sparse"] = {{"count", 2},
                          {"indices", {{"bufferView", places}, {"componentType", kUnsignedShort}}},
                          {"values", {{"bufferView", values}}}};
    const Loaded out = load(sample.glb());
    ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
    EXPECT_EQ(corners_of(*out.imported), (std::vector<Vec3>{{0, 0, 0}, {7, 8, 9}, {-1, -2, -3}}));
  }
}

Loaded with_indices(int mode, const std::vector<std::uint32_t>& list, int component) {
  Sample sample;
  std::vector<float> positions;
  for (int i = 0; i < 6; ++i)
    for (const int x : {i, i * i, 0}) positions.push_back(static_cast<float>(x));
  const int accessor = sample.numbers(positions, kFloat, "VEC3", 3);
  int view = 0;
  if (component == kUnsignedByte)
    view = sample.view(std::vector<std::uint8_t>(list.begin(), list.end()));
  else if (component == kUnsignedShort)
    view = sample.view(std::vector<std::uint16_t>(list.begin(), list.end()));
  else
    view = sample.view(list);
  const int indices = sample.accessor(view, component, list.size(), "SCALAR");
  sample.add_mesh({{"attributes", {{"POSITION", accessor}}}, {"indices", indices}, {"mode", mode}});
  Options options;
  options.crease_angle = kPi;  // vertices stay as they are
  return load(sample.gltf(), options);
}

TEST(GltfReader, ListsStripsAndFansOfEveryIndexType) {
  using List = std::vector<geometry::Triangle>;
  for (const int component : {kUnsignedByte, kUnsignedShort, kUnsignedInt}) {
    auto out = with_indices(4, {0, 1, 2, 5, 4, 3}, component);
    ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
    EXPECT_EQ(mesh_of(*out.imported).triangles, (List{{0, 1, 2}, {5, 4, 3}}));
    out = with_indices(5, {0, 1, 2, 3, 4}, component);
    ASSERT_TRUE(out.imported) << out.text();
    // each has the orientation of the first
    EXPECT_EQ(mesh_of(*out.imported).triangles, (List{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}}));
    out = with_indices(6, {0, 1, 2, 3}, component);
    ASSERT_TRUE(out.imported) << out.text();
    EXPECT_EQ(mesh_of(*out.imported).triangles, (List{{1, 2, 0}, {2, 3, 0}}));
    out = with_indices(1, {0, 1, 2, 3}, component);
    ASSERT_TRUE(out.imported) << out.text();
    EXPECT_TRUE(out.imported->scene.instances.empty());
    EXPECT_TRUE(out.log.contains(Code("N6007")));
  }
}

TEST(GltfReader, AnIndexPastTheLastVertexOrARestartCostsItsTriangle) {
  auto out = with_indices(4, {0, 1, 2, 3, 4, 6}, kUnsignedByte);
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_TRUE(out.log.contains(Code("E6207")));
  EXPECT_EQ(mesh_of(*out.imported).triangles.size(), 1u);
  out = with_indices(5, {0, 1, 2, 255, 3, 4, 5}, kUnsignedByte);
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_TRUE(out.log.contains(Code("E6207")));
  EXPECT_EQ(mesh_of(*out.imported).triangles,
            (std::vector<geometry::Triangle>{{0, 1, 2}, {3, 4, 5}}));
}

TEST(GltfReader, MatricesOfAnyKind) {
  const Mat4 mirrored(Vec4(-1, 0, 0, 0), Vec4(0, 2, 0, 0), Vec4(0, 0, 3, 0), Vec4(1, 2, 3, 1));
  const Mat4 sheared(Vec4(1, 0.25, 0, 0), Vec4(0.5, 1, 0, 0), Vec4(0, 0.125, 1, 0),
                     Vec4(4, 5, 6, 1));
  for (const Mat4& matrix : {mirrored, sheared}) {
    Sample sample = triangle();
    json list = json::array();
    for (int k = 0; k < 16; ++k) list.push_back(matrix[k / 4][k % 4]);
    sample.json["nodes"][0]["matrix"] = list;
    const Loaded out = load(sample.glb());
    ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
    std::vector<Vec3> wanted;
    for (const Vec3& p : kTriangle) wanted.push_back(Vec3(matrix * Vec4(p, 1)));
    EXPECT_LE(distance(corners_of(*out.imported), wanted), 2e-15);  // measured 9e-16
  }
  Sample flat = triangle();
  flat.json["nodes"][0]["scale"] = {1, 0, 1};
  const Loaded out = load(flat.glb());
  ASSERT_TRUE(out.imported);
  EXPECT_TRUE(out.log.contains(Code("W6009")) && !out.log.has_errors());
}

TEST(GltfReader, InstancesAreNodes) {
  Sample sample = triangle();
  const double half = std::sqrt(0.5);
  const int moves =
      sample.numbers(std::vector<float>{0, 0, 0, 10, 0, 0, 0, 20, 0}, kFloat, "VEC3", 3);
  const auto h = static_cast<float>(half);
  const int turns =
      sample.numbers(std::vector<float>{0, 0, 0, 1, 0, 0, h, h, 0, 0, 0, 1}, kFloat, "VEC4", 4);
  sample.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  sample.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", moves}, {"ROTATION", turns}};
  const Loaded out = load(sample.glb());
  ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
  EXPECT_EQ(out.imported->scene.shapes.size(), 1u);
  // a quarter turn about z: x → y, y → −x
  EXPECT_LE(distance(corners_of(*out.imported), {{0, 0, 0},
                                                 {1, 0, 0},
                                                 {0, 1, 0},
                                                 {10, 0, 0},
                                                 {10, 1, 0},
                                                 {9, 0, 0},
                                                 {0, 20, 0},
                                                 {1, 20, 0},
                                                 {0, 21, 0}}),
            1e-15);  // measured 3e-16
}

TEST(GltfReader, MorphedAndSkinnedMeshesStandAtRest) {
  Sample sample = triangle();
  const int moves =
      sample.numbers(std::vector<float>{0, 0, 4, 0, 0, 8, 0, 0, 0}, kFloat, "VEC3", 3);
  sample.json["accessors"][1]["min"] = sample.json["accessors"][1]["max"] = {0, 0, 0};
  sample.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", moves}}};
  sample.json["meshes"][0]["weights"] = {0.5};
  auto out = load(sample.glb());
  ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
  EXPECT_TRUE(out.log.contains(Code("N6214")));
  EXPECT_EQ(corners_of(*out.imported), (std::vector<Vec3>{{0, 0, 2}, {1, 0, 4}, {0, 1, 0}}));
  sample.json["nodes"][0]["weights"] = {0.25};
  out = load(sample.glb());
  ASSERT_TRUE(out.imported) << out.text();
  EXPECT_EQ(corners_of(*out.imported), (std::vector<Vec3>{{0, 0, 1}, {1, 0, 2}, {0, 1, 0}}));

  // two joints, at x + 3 and y + 5, and bind matrices of the identity; the node's own place is not
  // that of its skinned mesh
  Sample skinned = triangle();
  const int joints = skinned.numbers(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0},
                                     kUnsignedByte, "VEC4", 4);
  const int weights = skinned.numbers(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0},
                                      kFloat, "VEC4", 4);
  json& attributes = skinned.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = joints;
  attributes["WEIGHTS_0"] = weights;
  skinned.json["nodes"][0]["skin"] = 0;
  skinned.json["nodes"][0]["translation"] = {100, 100, 100};
  skinned.json["nodes"].push_back({{"translation", {3, 0, 0}}, {"children", {2}}});
  skinned.json["nodes"].push_back({{"translation", {-3, 5, 0}}});
  skinned.json["scenes"][0]["nodes"].push_back(1);
  skinned.json["skins"] = {{{"joints", {1, 2}}}};
  out = load(skinned.glb());
  ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
  EXPECT_EQ(corners_of(*out.imported), (std::vector<Vec3>{{3, 0, 0}, {1, 5, 0}, {1.5, 3.5, 0}}));
}

TEST(GltfReader, AMeshWithJointsHasNormalsWhereNoSkinMovesIt) {
  Sample sample = triangle();
  const int joints = sample.numbers(std::vector<std::uint8_t>(12, 0), kUnsignedByte, "VEC4", 4);
  const int weights =
      sample.numbers(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, kFloat, "VEC4", 4);
  json& attributes = sample.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = joints;
  attributes["WEIGHTS_0"] = weights;
  sample.json["nodes"][0]["skin"] = 0;
  sample.json["nodes"].push_back({{"mesh", 0}});
  sample.json["scenes"][0]["nodes"].push_back(1);
  sample.json["skins"] = {{{"joints", {0}}}};
  const Loaded out = load(sample.glb());
  ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
  ASSERT_EQ(out.imported->scene.instances.size(), 2u);
  for (const std::size_t i : {0, 1}) EXPECT_EQ(mesh_of(*out.imported, i).normals.size(), 3u);
}

TEST(GltfReader, ScenesByNameAndNumber) {
  Sample sample = triangle();
  sample.json["nodes"].push_back({{"mesh", 0}, {"translation", {5, 0, 0}}});
  sample.json["scenes"].push_back({{"nodes", {1}}, {"name", "flight"}});
  sample.json["scene"] = 0;
  for (const char* name : {"flight", "1"}) {
    Options options;
    options.scene = name;
    const Loaded out = load(sample.glb(), options);
    ASSERT_TRUE(out.imported) << out.text();
    EXPECT_EQ(corners_of(*out.imported)[0], Vec3(5, 0, 0));
  }
  Options options;
  options.scene = "ground";
  const Loaded out = load(sample.glb(), options);
  EXPECT_FALSE(out.imported);
  EXPECT_TRUE(out.log.contains(Code("E6205")));
}

TEST(GltfReader, BuffersInFilesOfTheFolderAlone) {
  Sample sample = triangle();
  const std::string bytes = sample.bytes;
  const auto with_uri = [&](const char* uri) {
    sample.json["buffers"] = {{{"byteLength", bytes.size()}, {"uri", uri}}};
    return load(sample.json.dump(), {}, {{"my data.bin", bytes}, {"sub/x.bin", bytes}});
  };
  for (const char* good : {"my%20data.bin", "my data.bin", "sub/x.bin", "./sub/../sub/x.bin"}) {
    const Loaded out = with_uri(good);
    ASSERT_TRUE(out.imported && !out.log.has_errors()) << good << out.text();
    EXPECT_EQ(corners_of(*out.imported), kTriangle);
    EXPECT_EQ(out.imported->scene.inputs.size(), 2u);
  }
  for (const char* bad : {"../x.bin", "%2e%2e/x.bin", "/etc/passwd", "sub/../../x.bin",
                          "http://example.org/x.bin", "none.bin", ""}) {
    const Loaded out = with_uri(bad);
    EXPECT_TRUE(out.log.contains(Code("E6206"))) << bad << out.text();
    if (out.imported) {
      EXPECT_TRUE(out.imported->scene.instances.empty());
    }
  }
}

TEST(GltfReader, TextureCoordinatesTurnedAndMirroredUpwards) {
  Sample sample = triangle();
  const int uv = sample.numbers(std::vector<float>{0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 2);
  json& primitive = sample.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = uv;
  primitive["material"] = 0;
  sample.json["extensionsUsed"] = {"KHR_texture_transform"};
  sample.json["textures"] = json::array({json::object()});
  // the example of the extension's page: the lower left quadrant, turned clockwise
  sample.json["materials"] = {
      {{"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", 0},
           {"extensions",
            {{"KHR_texture_transform",
              {{"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}}}}}}}}}}};
  const Loaded out = load(sample.glb());
  ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
  // (0,0) → (0,1), (1,0) → (0,½), (0,1) → (½,1), and v counted from the bottom
  const std::vector<Vec2>& got = mesh_of(*out.imported).texcoords;
  const std::vector<Vec2> wanted = {{0, 0}, {0, 0.5}, {0.5, 0}};
  ASSERT_EQ(got.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_LE(glm::length(got[i] - wanted[i]), 3e-12) << i;  // 5e-12·½: digits of the angle
}

TEST(GltfReader, VertexColorsOfEveryForm) {
  const auto colors = [](auto list, int component, const char* type, int width) {
    Sample sample = triangle();
    const int accessor =
        sample.accessor(sample.view(list, 0), component,
                        list.size() / static_cast<std::size_t>(width), type, component != kFloat);
    sample.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = accessor;
    const Loaded out = load(sample.glb());
    EXPECT_TRUE(out.imported && !out.log.has_errors()) << out.text();
    return out.imported ? mesh_of(*out.imported).colors : std::vector<Vec3>{};
  };
  const std::vector<Vec3> wanted = {{1, 0, 0.2}, {0, 1, 0}, {0.4, 0, 1}};
  EXPECT_LE(distance(colors(std::vector<float>{1, 0, 0.2f, 0, 1, 0, 0.4f, 0, 1}, kFloat, "VEC3", 3),
                     wanted),
            1e-8);
  EXPECT_LE(distance(colors(std::vector<std::uint8_t>{255, 0, 51, 9, 0, 255, 0, 9, 102, 0, 255, 9},
                            kUnsignedByte, "VEC4", 4),
                     wanted),
            1e-16);
  EXPECT_LE(distance(colors(std::vector<std::uint16_t>{65535, 0, 13107, 9, 0, 65535, 0, 9, 26214, 0,
                                                       65535, 9},
                            kUnsignedShort, "VEC4", 4),
                     wanted),
            1e-16);
}

TEST(GltfReader, ArticulationsAreJoints) {
  Sample sample = triangle();
  sample.json["extensionsUsed"] = {"AGI_articulations"};
  sample.json["nodes"][0]["extensions"]["AGI_articulations"]["articulationName"] = "Array";
  sample.json["extensions"]["AGI_articulations"]["articulations"] = {
      {{"name", "Array"},
       {"stages",
        {{{"name", "Turn"}, {"type", "yRotate"}, {"minimumValue", -90}, {"maximumValue", 45}},
         {{"name", "Out"}, {"type", "zTranslate"}, {"minimumValue", 0}, {"maximumValue", 2}},
         {{"name", "Size"},
          {"type", "uniformScale"},
          {"minimumValue", 0},
          {"maximumValue", 1},
          {"initialValue", 1}}}}}};
  const Loaded out = load(sample.glb());
  ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
  const auto& joints = out.imported->scene.joints;
  ASSERT_EQ(joints.size(), 3u);
  EXPECT_EQ(joints[0].name, "Array Turn");
  EXPECT_EQ(joints[0].kind, scene::JointKind::revolute);
  EXPECT_EQ(joints[0].axis, Vec3(0, 1, 0));
  EXPECT_EQ(joints[0].lower, std::vector<double>{-kPi / 2});
  EXPECT_EQ(joints[0].upper, std::vector<double>{kPi / 4});
  EXPECT_EQ(joints[1].kind, scene::JointKind::prismatic);
  EXPECT_EQ(joints[1].upper, std::vector<double>{2.0});
  EXPECT_EQ(joints[2].kind, scene::JointKind::scale);
  EXPECT_TRUE(joints[2].value.empty());  // at rest
}

// One articulation of two nodes: the second node's joints follow the first one's. Initial values,
// and a direction that points, with two stages that turn it.
TEST(GltfReader, ArticulationsBeginWhereTheySay) {
  Sample sample = triangle();
  sample.json["extensionsUsed"] = {"AGI_articulations"};
  sample.json["nodes"].push_back(sample.json["nodes"][0]);
  for (auto& node : sample.json["nodes"])
    node["extensions"]["AGI_articulations"]["articulationName"] = "Dish";
  sample.json["scenes"] = {{{"nodes", {0, 1}}}};
  sample.json["scene"] = 0;
  sample.json["extensions"]["AGI_articulations"]["articulations"] = {{{"name", "Dish"},
                                                                      {"pointingVector", {0, 0, 2}},
                                                                      {"stages",
                                                                       {{{"name", "Az"},
                                                                         {"type", "zRotate"},
                                                                         {"minimumValue", -180},
                                                                         {"maximumValue", 180},
                                                                         {"initialValue", 30}},
                                                                        {{"name", "El"},
                                                                         {"type", "yRotate"},
                                                                         {"minimumValue", 0},
                                                                         {"maximumValue", 90},
                                                                         {"initialValue", 45}}}}}};
  const Loaded out = load(sample.glb());
  ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
  EXPECT_FALSE(out.log.contains(Code("N6007")));
  const auto& joints = out.imported->scene.joints;
  ASSERT_EQ(joints.size(), 4u);
  EXPECT_EQ(joints[0].kind, scene::JointKind::continuous);
  EXPECT_EQ(joints[0].value, std::vector<double>{30 * kDegree});
  EXPECT_EQ(joints[1].value, std::vector<double>{45 * kDegree});
  EXPECT_EQ(joints[1].pointing, Vec3(0, 0, 1));
  EXPECT_EQ(joints[1].gimbal, 0);
  EXPECT_EQ(joints[2].mimic, 0);
  EXPECT_EQ(joints[3].mimic, 1);
  EXPECT_EQ(scene::check(out.imported->scene), "");
}

TEST(GltfReader, NormalsAreUnitAndMissingOnesFollowTheFacets) {
  Sample sample = triangle();
  const auto plain = load(sample.glb());
  ASSERT_TRUE(plain.imported);
  for (const Vec3& n : mesh_of(*plain.imported).normals) EXPECT_EQ(n, Vec3(0, 0, 1));
  const int normals =
      sample.numbers(std::vector<float>{0, 0, 2, 0, 0, 0, 0.6f, 0, 0.8f}, kFloat, "VEC3", 3);
  sample.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals;
  const auto out = load(sample.glb());
  ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
  EXPECT_TRUE(out.log.contains(Code("W6212")));
  EXPECT_LE(distance(mesh_of(*out.imported).normals, {{0, 0, 1}, {0, 0, 1}, {0.6, 0, 0.8}}), 3e-8);
}

}  // namespace
}  // namespace panwright::importers::reader_test
