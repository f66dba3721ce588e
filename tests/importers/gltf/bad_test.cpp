// Damaged and hostile files: each has its diagnostic, and none costs more than it may.

#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cstring>
#include <filesystem>
#include <limits>

#include "tests/importers/gltf/sample.h"
#include "tests/support/paths.h"

namespace panwright::importers::bad_test {
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
  const int colors = sample.numbers(
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
      {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"COLOR_0", colors}}},
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
    expect_code("bufferViews", 0, {{"byteOffset", offset + 1000}}, Code("E6206"));
    expect_code("accessors", 0, {{"byteOffset", offset * 4 + 1000}}, Code("E6206"));
    expect_code("accessors", 0, {{"count", offset + 1000}}, Code("E6206"));
    expect_code("bufferViews", 0, {{"byteLength", offset + 1000}}, Code("E6206"));
  }
  expect_code("accessors", 0, {{"count", 0}}, Code("E6204"));
  expect_code("accessors", 0, {{"count", -3}}, Code("E6204"));
  expect_code("accessors", 0, {{"count", 1.5}}, Code("E6204"));
  expect_code("accessors", 0, {{"byteOffset", 2}}, Code("E6206"));
  expect_code("bufferViews", 0, {{"byteStride", 8}}, Code("E6206"));
  expect_code("bufferViews", 0, {{"byteStride", 300}}, Code("E6204"));
  expect_code("bufferViews", 0, {{"byteStride", 26}}, Code("E6204"));
  expect_code("bufferViews", 0, {{"buffer", 7}}, Code("E6205"));
  expect_code("accessors", 2, {{"componentType", kFloat}}, Code("E6211"));
  expect_code("accessors", 1, {{"count", 3}}, Code("E6211"));
  expect_code("nodes", 0, {{"mesh", 4}}, Code("E6205"));
  expect_code("nodes", 1, {{"children", {0, 1}}}, Code("E6208"));
  expect_code("nodes", 0, {{"children", {1}}}, Code("E6208"));
  expect_code("nodes", 1, {{"rotation", {0, 0, 0, 0.5}}}, Code("E6204"));
  expect_code({{"scene", 3}}, Code("E6205"));
  expect_code({{"asset", {{"version", "1.0"}}}}, Code("E6202"));
  expect_code({{"asset", nullptr}}, Code("E6204"));
  expect_code({{"extensionsRequired", {"VENDOR_shapes"}}}, Code("E6209"));
  expect_code({{"nodes", 5}}, Code("E6204"));
}

// A triangle on two joints, with half of its weight on each.
Sample skinned() {
  Sample sample;
  const int positions =
      sample.numbers(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, kFloat, "VEC3", 3);
  sample.json["accessors"][0]["min"] = {0, 0, 0};
  sample.json["accessors"][0]["max"] = {1, 1, 0};
  const int joints = sample.numbers(std::vector<std::uint8_t>{0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0},
                                    kUnsignedByte, "VEC4", 4);
  const int weights = sample.numbers(
      std::vector<float>{0.5, 0.5, 0, 0, 0.5, 0.5, 0, 0, 0.5, 0.5, 0, 0}, kFloat, "VEC4", 4);
  std::vector<float> matrices(32);
  for (std::size_t i = 0; i < 32; ++i) matrices[i] = i % 16 % 5 == 0 ? 1 : 0;
  const int inverse = sample.numbers(matrices, kFloat, "MAT4", 16);
  sample.add_mesh(
      {{"attributes", {{"POSITION", positions}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}});
  sample.json["nodes"][0]["skin"] = 0;
  sample.json["nodes"].push_back({{"children", {2}}});
  sample.json["nodes"].push_back({{"translation", {0, 0, 0}}});
  sample.json["scenes"][0]["nodes"] = {0, 1};
  sample.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse}}};
  return sample;
}

// The verdict of the Khronos validator, 2.0.0-dev.3.10, on each of these files: its error, or
// nothing where it has none.
struct Judged {
  const char* change;  // a JSON merge patch
  const char* theirs;
};

void expect_verdicts(const Sample& base, const std::vector<Judged>& cases) {
  const Loaded whole = load(base.glb());
  ASSERT_TRUE(whole.imported && !whole.log.has_errors()) << whole.text();
  for (const Judged& one : cases) {
    Sample sample = base;
    sample.json.merge_patch(json::parse(one.change));
    const Loaded out = load(sample.glb());
    expect_sound(out, one.change);
    EXPECT_EQ(out.log.has_errors(), std::string_view(one.theirs) != "")
        << one.change << " " << one.theirs << "\n"
        << out.text();
  }
}

TEST(GltfBad, VerdictsOfTheValidator) {
  expect_verdicts(
      triangle(),
      {
          {R"({"nodes":[{"mesh":0,"rotation":[0.5,0.5,0.5,0.5153]}]})", "ROTATION_NON_UNIT"},
          {R"({"nodes":[{"mesh":0,"rotation":[0.5,0.5,0.5,0.515]}]})", ""},
          {R"({"nodes":[{"mesh":0,"rotation":[0.5,0.5,0.5,0.49]}]})", ""},
          {R"({"nodes":[{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1]}]})", ""},
          {R"({"nodes":[{"mesh":0,"matrix":[1,0.5,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}]})",
           "NODE_MATRIX_NON_TRS"},
          {R"({"nodes":[{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,0,0,0,0,0,1]}]})",
           "NODE_MATRIX_NON_TRS"},
          {R"({"nodes":[{"mesh":0,"matrix":[0,0,-3,0,0,2,0,0,1,0,0,0,0,0,0,1]}]})", ""},
          {R"({"nodes":[{"mesh":0,"matrix":[-1,0,0,0,0,-1,0,0,0,0,-1,0,0,0,0,1]}]})", ""},
          {R"({"animations":[{"samplers":[{"input":0,"output":0}],
               "channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]}]})",
           "ACCESSOR_USAGE_OVERRIDE"},
          {R"({"asset":{"version":"02.0"}})", ""},
          {R"({"asset":{"version":"2.0","minVersion":"2.1"}})",
           "ASSET_MIN_VERSION_GREATER_THAN_VERSION"},
          {R"({"asset":{"version":"2.1","minVersion":"2.0"}})", ""},
          {R"({"extensionsUsed":["VENDOR_a","VENDOR_a"]})", "DUPLICATE_ELEMENTS"},
          {R"({"extensionsRequired":["KHR_materials_unlit"]})", "UNSATISFIED_DEPENDENCY"},
          {R"({"cameras":[{"type":"foo"}]})", ""},
          {R"({"cameras":[{"type":"perspective"}]})", "UNDEFINED_PROPERTY"},
          {R"({"extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":
               {"lights":[{"type":"spot","spot":{"innerConeAngle":2}}]}}})",
           ""},  // theirs: VALUE_NOT_IN_RANGE, here W6215
          {R"({"extensionsUsed":["KHR_materials_dispersion"],"materials":[{"extensions":
               {"KHR_materials_dispersion":{"dispersion":-1}}}]})",
           ""},
          {R"({"extensionsUsed":["KHR_materials_ior"],"materials":[{"extensions":
               {"KHR_materials_ior":{"ior":1.5,"extensions":[]}}}]})",
           "TYPE_MISMATCH"},
          {R"({"extensionsUsed":["KHR_materials_variants"],"extensions":
               {"KHR_materials_variants":{"variants":[{}]}}})",
           "UNDEFINED_PROPERTY"},
          {R"({"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAA==="}]})",
           "INVALID_URI"},
          {R"({"buffers":[{"byteLength":3,"uri":"data:octets;base64,AAAA"}],"bufferViews":null,
               "accessors":null,"meshes":null,"nodes":null,"scenes":null})",
           "INVALID_URI"},
          {R"({"buffers":[{"byteLength":3,"uri":"DATA:APPLICATION/octet-stream;base64,AAAA"}],
               "bufferViews":null,"accessors":null,"meshes":null,"nodes":null,"scenes":null})",
           ""},
          {R"({"buffers":[{"byteLength":4,"uri":"data:application/octet-stream;base64,AAAAAA%3D%3D"}],
               "bufferViews":null,"accessors":null,"meshes":null,"nodes":null,"scenes":null})",
           ""},
      });
}

// Changes to one element of a list, as merge patches replace lists as a whole.
TEST(GltfBad, VerdictsOfTheValidatorOnAccessors) {
  struct Case {
    const char* list;
    std::size_t index;
    const char* change;
    const char* theirs;
  };
  const auto verdict = [](Sample sample, const Case& one) {
    sample.json[one.list][one.index].merge_patch(json::parse(one.change));
    const Loaded out = load(sample.glb());
    expect_sound(out, one.change);
    EXPECT_EQ(out.log.has_errors(), std::string_view(one.theirs) != "")
        << one.list << one.index << one.change << " " << one.theirs << "\n"
        << out.text();
  };
  for (const Case& one : {
           Case{"accessors", 2, R"({"min":[0],"max":[3]})", ""},
           Case{"accessors", 2, R"({"min":[0.5]})", "ARRAY_TYPE_MISMATCH"},
           Case{"accessors", 2, R"({"min":[-1]})", "INVALID_GL_VALUE"},
           Case{"accessors", 2, R"({"max":[65536]})", "INVALID_GL_VALUE"},
           Case{"accessors", 2, R"({"max":[]})", "ARRAY_LENGTH_NOT_IN_LIST"},
           Case{"accessors", 2, R"({"componentType":7})",
                "MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT"},
           Case{"accessors", 1, R"({"type":"VEC5"})",
                "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT"},
           Case{"bufferViews", 0, R"({"target":34963})", "BUFFER_VIEW_INVALID_BYTE_STRIDE"},
           Case{"bufferViews", 0, R"({"byteStride":100})", "BUFFER_VIEW_TOO_BIG_BYTE_STRIDE"},
           Case{"accessors", 3, R"({"sparse":{"count":1,"indices":{"bufferView":3,
                "componentType":5121},"values":{"bufferView":4}}})",
                ""},
           Case{"accessors", 3, R"({"sparse":{"count":2,"indices":{"bufferView":4,
                "componentType":5121},"values":{"bufferView":4}}})",
                "ACCESSOR_SPARSE_INDICES_NON_INCREASING"},
       })
    verdict(rich(), one);
  for (const Case& one : {
           Case{"skins", 0, R"({"joints":[1]})", "ACCESSOR_JOINTS_INDEX_OOB"},
           Case{"bufferViews", 3, R"({"byteStride":64})", "SKIN_IBM_ACCESSOR_WITH_BYTESTRIDE"},
           Case{"accessors", 3, R"({"componentType":7})", "SKIN_IBM_INVALID_FORMAT"},
       })
    verdict(skinned(), one);
}

// One number of the skinned triangle changed.
TEST(GltfBad, VerdictsOfTheValidatorOnNumbers) {
  const Sample base = skinned();
  const Loaded whole = load(base.glb());
  ASSERT_TRUE(whole.imported && !whole.log.has_errors()) << whole.text();
  const auto changed = [&](std::size_t view, std::size_t at, float to) {
    Sample sample = base;
    const auto offset = sample.json["bufferViews"][view]["byteOffset"].get<std::size_t>();
    std::memcpy(sample.bytes.data() + offset + 4 * at, &to, sizeof to);
    return load(sample.glb());
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(changed(0, 0, kNan).log.contains(Code("E6207")));   // ACCESSOR_INVALID_FLOAT
  EXPECT_TRUE(changed(2, 0, -0.5f).log.contains(Code("E6207")));  // ACCESSOR_WEIGHTS_NEGATIVE
  EXPECT_TRUE(changed(3, 15, 2).log.contains(Code("E6207")));     // ACCESSOR_INVALID_IBM
  EXPECT_FALSE(changed(3, 12, 2).log.has_errors());
  Sample twice = base;
  const auto joints = twice.json["bufferViews"][1]["byteOffset"].get<std::size_t>();
  twice.bytes[joints] = 1;  // ACCESSOR_JOINTS_INDEX_DUPLICATE
  const Loaded out = load(twice.glb());
  EXPECT_TRUE(out.log.contains(Code("W6212")) && !out.log.has_errors()) << out.text();
}

// A custom attribute is not read, and still a number of it that is not finite is said; what sparse
// values stand over is not.
TEST(GltfBad, NumbersThatNobodyReads) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Sample sample = triangle();
  const int extra = sample.numbers(std::vector<float>{0, kNan, 0}, kFloat, "SCALAR", 1);
  sample.json["meshes"][0]["primitives"][0]["attributes"]["_EXTRA"] = extra;
  EXPECT_TRUE(load(sample.glb()).log.contains(Code("E6207")));
  const int places = sample.view(std::vector<std::uint8_t>{1});
  const int values = sample.view(std::vector<float>{5});
  sample.json["accessors"][1]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", places}, {"componentType", kUnsignedByte}}},
      {"values", {{"bufferView", values}}}};
  const Loaded out = load(sample.glb());
  EXPECT_FALSE(out.log.has_errors()) << out.text();
}

TEST(GltfBad, ZeroBytesAfterTheJson) {
  const std::string text = triangle().gltf();
  Loaded out = load(text + std::string(3, '\0'));
  EXPECT_TRUE(out.log.contains(Code("E6203"))) << out.text();
  ASSERT_TRUE(out.imported);
  EXPECT_EQ(mesh_of(*out.imported).triangles.size(), 1u);
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
  code_of(glb, Code("E6202"));
  glb[4] = 3;
  code_of(glb, Code("E6201"));
  code_of(R"({"asset":{"version":"2.0"},"meshes":{"a":{}}})", Code("E6204"));
  code_of(R"({"meshes":{"a":{}}})", Code("E6202"));
  code_of(R"({"asset":{"version":"2.0"},})", Code("E6203"));
  code_of(R"({"asset":{"version":"2.0"},"scene":1e999})", Code("E6203"));
  code_of(R"({"asset":{"version":"2.0"},"asset":{"version":"2.0"}})", Code("W6215"));
  code_of("{\"a\":" + std::string(100000, '[') + std::string(100000, ']') + "}", Code("E6203"));
}

TEST(GltfBad, MessagesNameTheProperty) {
  const std::string bytes =
      R"({"asset":{"version":"2.0"},"meshes":3,"nodes":[{"translation":"abc"},{"scale":[1,2]},{"children":[1,1]}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":1,"byteStride":3}],"cameras":[{"type":"wide"}]})";
  // note: the log refers to the bytes
  const std::vector<MemoryFile> files{{"m.gltf", bytes}};
  DiagnosticLog log;
  (void)import_memory(files, {}, log);
  EXPECT_TRUE(log.has_errors());
  const std::string text = to_text(log);
  for (const char* words :
       {"meshes is 3, expected a list", "translation is 'abc', expected a list",
        "scale has 2 numbers, expected 3", "children[1] repeats the index 1",
        "byteStride is 3, expected 4 to 252", "type is 'wide', expected one of"})
    EXPECT_NE(text.find(words), text.npos) << words << "\n" << text;
}

TEST(GltfBad, LargeClaimsOfSmallFiles) {
  // 48 GB of zeros
  Sample zeros = triangle();
  zeros.json["accessors"][0].erase("bufferView");
  zeros.json["accessors"][0]["count"] = 2'000'000'000;
  Loaded out = load(zeros.glb());
  EXPECT_TRUE(out.log.contains(Code("E6002"))) << out.text();
  // meshopt and Draco streams of a few bytes
  Sample packed = triangle();
  packed.json["extensionsUsed"] = {"EXT_meshopt_compression"};
  packed.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                                            {"byteLength", 36},
                                                                            {"byteStride", 12},
                                                                            {"count", 100'000'000},
                                                                            {"mode", "ATTRIBUTES"}};
  out = load(packed.glb());
  EXPECT_TRUE(out.log.contains(Code("E6210"))) << out.text();
  Sample draco = triangle();
  std::vector<std::uint8_t> head = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, 0, 0, 0};
  for (int i = 0; i < 2; ++i) head.insert(head.end(), {0xff, 0xff, 0xff, 0xff, 0x0f});
  const int view = draco.view(head);
  draco.json["extensionsUsed"] = draco.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  draco.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  out = load(draco.glb());
  EXPECT_TRUE(out.log.contains(Code("E6210"))) << out.text();
  // limits of the caller
  Options options;
  options.limits.nodes = 2;
  out = load(rich().glb(), options);
  EXPECT_TRUE(out.log.contains(Code("E6002"))) << out.text();
  options = {};
  options.limits.triangles = 1;
  out = load(rich().glb(), options);
  EXPECT_TRUE(out.log.contains(Code("E6002"))) << out.text();
  options = {};
  options.limits.depth = 1;
  out = load(rich().glb(), options);
  EXPECT_TRUE(out.log.contains(Code("E6002"))) << out.text();
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
                    .log.contains(Code("E6210")))
        << size;
  for (std::size_t at = 0; at < stream.size(); ++at) {
    std::vector<unsigned char> bytes = stream;
    bytes[at] ^= 0x55;
    expect_sound(file(bytes), std::to_string(at));
  }
}

}  // namespace
}  // namespace panwright::importers::bad_test
