// Damaged and hostile files: each has its diagnostic, and none costs more than it may.

#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <filesystem>

#include "tests/importers/gltf/sample.h"

namespace panwright::importers {
namespace {

using nlohmann::json;

// A file with most of what files have.
Sample rich() {
  Sample sample;
  const int view = sample.view(
      std::vector<float>{0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 1},
      24);
  const int positions = sample.accessor(view, kFloat, 4, "VEC3");
  const int normals = sample.accessor(view, kFloat, 4, "VEC3");
  sample.json["accessors"][1]["byteOffset"] = 12;
  const int indices =
      sample.numbers(std::vector<std::uint16_t>{0, 1, 2, 2, 1, 3}, kUnsignedShort, "SCALAR", 1);
  const int colours = sample.numbers(
      std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16},
      kUnsignedByte, "VEC4", 4);
  sample.json["accessors"][3]["normalized"] = true;
  const int places = sample.view(std::vector<std::uint8_t>{1, 3});
  const int values = sample.view(std::vector<float>{1, 0, 0.5, 1, 1, 0.5});
  sample.json["accessors"][0]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", places}, {"componentType", kUnsignedByte}}},
      {"values", {{"bufferView", values}}}};
  sample.add_mesh(
      {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"COLOR_0", colours}}},
       {"indices", indices},
       {"material", 0}});
  sample.json["nodes"].push_back({{"children", {0}}, {"rotation", {0, 0, 0, 1}}, {"name", "arm"}});
  sample.json["scenes"][0]["nodes"] = {1};
  sample.json["materials"] = {{{"pbrMetallicRoughness",
                                {{"baseColorFactor", {0.5, 0.25, 0.125, 1}},
                                 {"metallicFactor", 0.5},
                                 {"roughnessFactor", 0.5}}}}};
  return sample;
}

void expect_sound(const Loaded& out, const std::string& what) {
  if (!out.imported) {
    EXPECT_TRUE(out.log.has_errors()) << what;
    return;
  }
  EXPECT_EQ(scene::check(out.imported->scene), "") << what;
}

TEST(GltfBad, TheWholeFileIsSound) {
  const Loaded out = load(rich().glb());
  ASSERT_TRUE(out.imported && !out.log.has_errors()) << out.text();
  EXPECT_EQ(mesh_of(*out.imported).triangles.size(), 2u);
}

TEST(GltfBad, CutShortAtEveryByte) {
  const std::string whole = rich().glb();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Loaded out = load(whole.substr(0, size));
    expect_sound(out, std::to_string(size));
    EXPECT_TRUE(out.log.has_errors()) << size;
  }
  const std::string text = rich().gltf();
  for (std::size_t size = 0; size + 1 < text.size(); ++size) {
    const Loaded out = load(text.substr(0, size));
    EXPECT_FALSE(out.imported) << size;
    EXPECT_TRUE(out.log.has_errors()) << size;
  }
}

TEST(GltfBad, EveryByteChanged) {
  for (const std::string& whole : {rich().glb(), rich().gltf()})
    for (std::size_t at = 0; at < whole.size(); ++at)
      for (const int mask : {1, 0x80, 0xff}) {
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ mask);
        expect_sound(load(bytes), std::to_string(at));
      }
}

// What a change to the JSON must be called.
void expect_code(const json& change, Code code) {
  Sample sample = rich();
  sample.json.merge_patch(change);
  const Loaded out = load(sample.glb());
  expect_sound(out, change.dump());
  EXPECT_TRUE(out.log.contains(code)) << change.dump() << "\n" << out.text();
}

// The same for one element of a list.
void expect_code(const char* list, std::size_t index, const json& change, Code code) {
  Sample sample = rich();
  sample.json[list][index].merge_patch(change);
  const Loaded out = load(sample.glb());
  expect_sound(out, change.dump());
  EXPECT_TRUE(out.log.contains(code)) << list << change.dump() << "\n" << out.text();
}

TEST(GltfBad, OffsetsCountsAndStrides) {
  for (const std::uint64_t offset :
       {std::uint64_t{4}, ~std::uint64_t{0} - 15, std::uint64_t{1} << 63, std::uint64_t{1} << 32}) {
    expect_code("bufferViews", 0, {{"byteOffset", offset + 1000}}, Code::E6206);
    expect_code("accessors", 0, {{"byteOffset", offset * 4 + 1000}}, Code::E6206);
    expect_code("accessors", 0, {{"count", offset + 1000}}, Code::E6206);
    expect_code("bufferViews", 0, {{"byteLength", offset + 1000}}, Code::E6206);
  }
  expect_code("accessors", 0, {{"count", 0}}, Code::E6204);
  expect_code("accessors", 0, {{"count", -3}}, Code::E6204);
  expect_code("accessors", 0, {{"count", 1.5}}, Code::E6204);
  expect_code("accessors", 0, {{"byteOffset", 2}}, Code::E6206);
  expect_code("bufferViews", 0, {{"byteStride", 8}}, Code::E6206);
  expect_code("bufferViews", 0, {{"byteStride", 300}}, Code::E6204);
  expect_code("bufferViews", 0, {{"byteStride", 26}}, Code::E6204);
  expect_code("bufferViews", 0, {{"buffer", 7}}, Code::E6205);
  expect_code("accessors", 2, {{"componentType", kFloat}}, Code::E6211);
  expect_code("accessors", 1, {{"count", 3}}, Code::E6211);
  expect_code("nodes", 0, {{"mesh", 4}}, Code::E6205);
  expect_code("nodes", 1, {{"children", {0, 1}}}, Code::E6208);
  expect_code("nodes", 0, {{"children", {1}}}, Code::E6208);
  expect_code("nodes", 1, {{"rotation", {0, 0, 0, 0.5}}}, Code::E6204);
  expect_code({{"scene", 3}}, Code::E6205);
  expect_code({{"asset", {{"version", "1.0"}}}}, Code::E6202);
  expect_code({{"asset", nullptr}}, Code::E6204);
  expect_code({{"extensionsRequired", {"VENDOR_shapes"}}}, Code::E6209);
  expect_code({{"nodes", 5}}, Code::E6204);
}

// Files named after what is wrong with them, for people and for the test of all codes.
TEST(GltfBad, FilesNamedAfterTheirCode) {
  int files = 0;
  const std::filesystem::path folder = PANWRIGHT_SOURCE_DIR "/tests/importers/gltf/data/bad";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    DiagnosticLog log;
    const auto imported = import_file(entry.path(), {}, log);
    const auto code = code_from_name(entry.path().stem().string());
    ASSERT_TRUE(code) << entry.path();
    EXPECT_TRUE(log.contains(*code)) << entry.path() << "\n" << to_text(log);
    EXPECT_EQ(log.has_errors(), code_info(*code).severity == Severity::error) << to_text(log);
    ++files;
  }
  EXPECT_EQ(files, 15);
}

TEST(GltfBad, ContainersAndText) {
  const auto code_of = [](const std::string& bytes, Code code) {
    const Loaded out = load(bytes);
    expect_sound(out, "");
    EXPECT_TRUE(out.log.contains(code)) << out.text();
  };
  std::string glb = rich().glb();
  glb[4] = 1;
  code_of(glb, Code::E6202);
  glb[4] = 3;
  code_of(glb, Code::E6201);
  code_of(R"({"asset":{"version":"2.0"},"meshes":{"a":{}}})", Code::E6204);
  code_of(R"({"meshes":{"a":{}}})", Code::E6202);
  code_of(R"({"asset":{"version":"2.0"},})", Code::E6203);
  code_of(R"({"asset":{"version":"2.0"},"scene":1e999})", Code::E6203);
  code_of(R"({"asset":{"version":"2.0"},"asset":{"version":"2.0"}})", Code::W6215);
  code_of("{\"a\":" + std::string(100000, '[') + std::string(100000, ']') + "}", Code::E6203);
}

TEST(GltfBad, LargeClaimsOfSmallFiles) {
  // 48 GB of zeros
  Sample zeros = triangle();
  zeros.json["accessors"][0].erase("bufferView");
  zeros.json["accessors"][0]["count"] = 2'000'000'000;
  Loaded out = load(zeros.glb());
  EXPECT_TRUE(out.log.contains(Code::E6002)) << out.text();
  // meshopt and Draco streams of a few bytes
  Sample packed = triangle();
  packed.json["extensionsUsed"] = {"EXT_meshopt_compression"};
  packed.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                                            {"byteLength", 36},
                                                                            {"byteStride", 12},
                                                                            {"count", 100'000'000},
                                                                            {"mode", "ATTRIBUTES"}};
  out = load(packed.glb());
  EXPECT_TRUE(out.log.contains(Code::E6210)) << out.text();
  Sample draco = triangle();
  std::vector<std::uint8_t> head = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, 0, 0, 0};
  for (int i = 0; i < 2; ++i) head.insert(head.end(), {0xff, 0xff, 0xff, 0xff, 0x0f});
  const int view = draco.view(head);
  draco.json["extensionsUsed"] = draco.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  draco.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  out = load(draco.glb());
  EXPECT_TRUE(out.log.contains(Code::E6210)) << out.text();
  // limits of the caller
  Options options;
  options.limits.nodes = 2;
  out = load(rich().glb(), options);
  EXPECT_TRUE(out.log.contains(Code::E6002)) << out.text();
  options = {};
  options.limits.triangles = 1;
  out = load(rich().glb(), options);
  EXPECT_TRUE(out.log.contains(Code::E6002)) << out.text();
  options = {};
  options.limits.depth = 1;
  out = load(rich().glb(), options);
  EXPECT_TRUE(out.log.contains(Code::E6002)) << out.text();
}

TEST(GltfBad, AMeshoptStreamDamagedAtEveryByte) {
  std::vector<float> positions;
  for (int i = 0; i < 300; ++i)
    for (const int x : {i % 20, i / 20, i % 7}) positions.push_back(static_cast<float>(x));
  std::vector<unsigned char> stream(meshopt_encodeVertexBufferBound(300, 12));
  stream.resize(
      meshopt_encodeVertexBuffer(stream.data(), stream.size(), positions.data(), 300, 12));
  const auto file = [&](const std::vector<unsigned char>& bytes) {
    Sample sample;
    sample.json["extensionsUsed"] = sample.json["extensionsRequired"] = {"EXT_meshopt_compression"};
    const int view = sample.view(bytes);
    sample.json["bufferViews"][0]["byteLength"] = bytes.size();
    sample.json["bufferViews"].push_back({{"buffer", 0},
                                          {"byteLength", 3600},
                                          {"byteStride", 12},
                                          {"extensions",
                                           {{"EXT_meshopt_compression",
                                             {{"buffer", 0},
                                              {"byteLength", bytes.size()},
                                              {"byteStride", 12},
                                              {"count", 300},
                                              {"mode", "ATTRIBUTES"}}}}}});
    sample.add_mesh(
        {{"attributes", {{"POSITION", sample.accessor(view + 1, kFloat, 300, "VEC3")}}}});
    return load(sample.glb());
  };
  const Loaded whole = file(stream);
  ASSERT_TRUE(whole.imported && !whole.log.has_errors()) << whole.text();
  const geometry::Mesh& mesh = mesh_of(*whole.imported);
  ASSERT_EQ(mesh.triangles.size(), 100u);
  for (std::size_t i = 0; i < 300; ++i) {
    const Vec3& got = mesh.positions[mesh.triangles[i / 3][i % 3]];
    EXPECT_EQ(got, Vec3(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]));
  }
  for (std::size_t size = 1; size < stream.size(); ++size)
    EXPECT_TRUE(file({stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(size)})
                    .log.contains(Code::E6210))
        << size;
  for (std::size_t at = 0; at < stream.size(); ++at) {
    std::vector<unsigned char> bytes = stream;
    bytes[at] ^= 0x55;
    expect_sound(file(bytes), std::to_string(at));
  }
}

}  // namespace
}  // namespace panwright::importers
