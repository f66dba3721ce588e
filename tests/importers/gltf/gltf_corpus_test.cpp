// Public glTF files against what the official validator says of them.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "base/text.h"
#include "importers/import.h"

namespace panwright::importers::gltf_corpus_test {
namespace {

namespace fs = std::filesystem;

struct Expected {
  std::string path;
  int errors = 0;
  bool refused = false;
  long triangles = -1;
  std::set<std::string> codes;
};

std::vector<std::string> split(const std::string& line, char mark) {
  std::vector<std::string> parts;
  std::stringstream stream(line);
  for (std::string part; std::getline(stream, part, mark);) parts.push_back(part);
  return parts;
}

fs::path corpus() {
  const char* other = std::getenv("PANWRIGHT_CORPUS");
  return other ? fs::path(other) : fs::path(PANWRIGHT_CORPUS_DIR);
}

std::vector<Expected> oracle() {
  std::vector<Expected> all;
  std::ifstream file(corpus() / "ORACLE-gltf.tsv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = split(line, '\t');
    Expected one;
    one.path = cells.at(0);
    one.refused = cells.at(1) == "refused";
    one.errors = one.refused ? 1 : std::stoi(cells[1]);
    if (cells.size() > 3 && !cells[3].empty()) one.triangles = std::stol(cells[3]);
    if (cells.size() > 5)
      for (const std::string& code : split(cells[5], ',')) one.codes.insert(code);
    all.push_back(std::move(one));
  }
  return all;
}

// Errors of the validator that change no triangle and lose none: W6212 or W6215 here, or nothing.
const std::map<std::string, const char*> kHarmless = {
    {"ACCESSOR_ELEMENT_OUT_OF_MAX_BOUND", "W6212: bounds are not used"},
    {"ACCESSOR_ELEMENT_OUT_OF_MIN_BOUND", "W6212: bounds are not used"},
    {"ACCESSOR_INVALID_SIGN", "tangents follow from texture coordinates"},
    {"ACCESSOR_JOINTS_INDEX_DUPLICATE", "W6212: weights of a joint are added"},
    {"ACCESSOR_MAX_MISMATCH", "W6212: bounds are not used"},
    {"ACCESSOR_MIN_MISMATCH", "W6212: bounds are not used"},
    {"ACCESSOR_NON_CLAMPED", "W6212: colours are clamped"},
    {"ACCESSOR_VECTOR3_NON_UNIT", "W6212: normals are made unit"},
    {"ACCESSOR_WEIGHTS_NON_NORMALIZED", "weights are divided by their sum"},
    {"ACCESSOR_ANIMATION_INPUT_NEGATIVE", "animations are left out"},
    {"ACCESSOR_ANIMATION_INPUT_NON_INCREASING", "animations are left out"},
    {"ANIMATION_CHANNEL_TARGET_NODE_MATRIX", "animations are left out"},
    {"ANIMATION_CHANNEL_TARGET_NODE_WEIGHTS_NO_MORPHS", "animations are left out"},
    {"ANIMATION_DUPLICATE_TARGETS", "animations are left out"},
    {"ANIMATION_SAMPLER_ACCESSOR_WITH_BYTESTRIDE", "animations are left out"},
    {"ANIMATION_SAMPLER_INPUT_ACCESSOR_INVALID_FORMAT", "animations are left out"},
    {"ANIMATION_SAMPLER_INPUT_ACCESSOR_TOO_FEW_ELEMENTS", "animations are left out"},
    {"ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS", "animations are left out"},
    {"ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_COUNT", "animations are left out"},
    {"ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_FORMAT", "animations are left out"},
    {"ACCESSOR_ANIMATION_SAMPLER_OUTPUT_NON_NORMALIZED_QUATERNION", "animations are left out"},
    {"BUFFER_DATA_URI_MIME_TYPE_INVALID", "W6215: the bytes are the same"},
    {"BUFFER_VIEW_TARGET_OVERRIDE", "a hint to graphics cards"},
    {"CAMERA_XMAG_YMAG_ZERO", "cameras are left out"},
    {"CAMERA_ZFAR_LEQUAL_ZNEAR", "cameras are left out"},
    {"EMPTY_ENTITY", "W6215: an empty list is no list"},
    {"IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE", "the texture is read by its first bytes"},
    {"IMAGE_MIME_TYPE_INVALID", "the texture is read by its first bytes"},
    {"IMAGE_NON_ENABLED_MIME_TYPE", "the texture is read by its first bytes"},
    {"IMAGE_UNEXPECTED_EOS", "W6004"},
    {"TEXTURE_INVALID_IMAGE_MIME_TYPE", "the texture is read by its first bytes"},
    {"IO_ERROR", "W6004 for a texture, E6206 for a buffer"},
    {"KHR_LIGHTS_PUNCTUAL_LIGHT_SPOT_ANGLES", "lights are left out"},
    {"MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY", "W6215: sets are found by name"},
    {"MESH_PRIMITIVE_INVALID_ATTRIBUTE", "W6215: the attribute is not read"},
    {"MESH_PRIMITIVE_NO_TANGENT_SPACE", "tangents follow from texture coordinates"},
    {"MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS", "W6212: bounds are not used"},
    {"MESH_PRIMITIVE_TOO_FEW_TEXCOORDS", "W6215: the texture is left out"},
    {"NODE_SKIN_NO_SCENE", "joints are found by index"},
    {"NODE_SKIN_WITH_NON_SKINNED_MESH", "W6215: the mesh stands as it is"},
    {"NON_REQUIRED_EXTENSION", "W6215: it is read all the same"},
    {"SKIN_NO_COMMON_ROOT", "W6215: joints are found by index"},
    {"SKIN_SKELETON_INVALID", "joints are found by index"},
    {"UNDECLARED_EXTENSION", "W6215: it is read all the same"},
    {"VALUE_NOT_IN_RANGE", "W6215: the nearest value is taken"},
    {"UNEXPECTED_EXTENSION_OBJECT", "W6215: it is left out"},
};

// Files whose verdict differs for a reason of their own.
const std::map<std::string, const char*> kOtherVerdict = {
    {"gltf-hard/asset-generator/Compatibility/Compatibility_05.gltf",
     "it requires FAKE_materials_quantumRendering; the validator takes what it does not know"},
    {"gltf-hard/magnum/required-extensions-unsupported.gltf",
     "the same, with extensions of its own"},
    {"spacecraft-gltf/ingenuity-gltfpack.glb",
     "W6215: factors of 1.00000012 are 1 but for rounding"},
};

// Files whose data differ from what the validator saw of them.
const std::map<std::string, const char*> kOtherBounds = {
    {"malformed/gltf-validator/base/data/mesh/primitive_generated_tangent_space.gltf",
     "normals without a view are 0, not unit"},
    {"malformed/gltf-validator/ext/KHR_materials_clearcoat/data/material/valid_with_tangent.gltf",
     "normals without a view are 0, not unit"},
};

bool needs_error(const Expected& expected) {
  if (expected.refused) return true;
  for (const std::string& code : expected.codes)
    if (!kHarmless.contains(code)) return true;
  // more codes than the table names may follow the first ones
  return false;
}

long triangles_of(const scene::Scene& scene) {
  // meshes that differ in their materials only share a shape here
  std::set<std::pair<std::int32_t, std::int32_t>> shapes;
  for (const auto& instance : scene.instances) shapes.insert({instance.shape, instance.material});
  long sum = 0;
  for (const auto& [shape, material] : shapes)
    sum += static_cast<long>(
        std::get<geometry::MeshShape>(scene.shapes[static_cast<std::size_t>(shape)])
            ->triangles.size());
  return sum;
}

TEST(GltfCorpus, VerdictsAreThoseOfTheValidator) {
  const std::vector<Expected> all = oracle();
  if (all.empty()) GTEST_SKIP() << "no corpus at " << corpus();
  std::map<std::string, int> sums;
  for (const Expected& expected : all) {
    DiagnosticLog log(200);
    const auto imported = import_file(corpus() / expected.path, {}, log);
    EXPECT_TRUE(imported || log.has_errors()) << expected.path;
    if (imported) {
      EXPECT_EQ(scene::check(imported->scene), "") << expected.path;
      EXPECT_EQ(imported->materials.size(), imported->scene.materials.size()) << expected.path;
    }
    if (kOtherVerdict.contains(expected.path)) continue;
    // a file without errors has none here; one with errors that matter has some
    if (expected.errors == 0 && log.has_errors())
      ADD_FAILURE() << expected.path << " is valid\n" << to_text(log);
    // bounds that the file gives are those of its positions
    if (expected.errors == 0 && log.contains(Code("W6212")) &&
        !kOtherBounds.contains(expected.path))
      ADD_FAILURE() << expected.path << " has other bounds\n" << to_text(log);
    if (needs_error(expected) && !log.has_errors())
      ADD_FAILURE() << expected.path
                    << " has errors: " << (expected.codes.empty() ? "" : *expected.codes.begin())
                    << "\n"
                    << to_text(log);
    ++sums[expected.errors == 0 ? "valid" : log.has_errors() ? "rejected" : "harmless errors"];
  }
  for (const auto& [what, count] : sums) std::printf("%s: %d\n", what.c_str(), count);
}

// The validator counts each mesh once, used or not; so do these.
const std::map<std::string, const char*> kOtherCount = {
    {"gltf-hard/asset-generator/Animation_Skin/Animation_Skin_11.gltf",
     "one mesh under two skins stands twice"},
    {"gltf-hard/sharpgltf/InfiniteSkinnedTentacle.glb", "one mesh under 84 skins"},
    {"gltf-hard/asset-generator/Material_AlphaMask/Material_AlphaMask_03.gltf",
     "alpha below its cut-off"},
    {"spacecraft-gltf/juno-draco-webp.glb", "609 triangles of alpha 0"},
    {"malformed/asset-generator/Mesh_NoPosition/Mesh_NoPosition_00.gltf", "no positions"},
    {"malformed/gltf-validator/base/data/mesh/custom_property.gltf", "no positions"},
    {"malformed/gltf-validator/base/data/mesh/primitive_generated_tangent_space.gltf",
     "no node has the mesh"},
    {"malformed/gltf-validator/base/data/mesh/primitive_incompatible_mode.gltf",
     "no node has the mesh"},
    {"malformed/gltf-validator/base/data/mesh/primitive_no_position.gltf", "no positions"},
    {"malformed/gltf-validator/base/data/mesh/valid.gltf", "no node has the mesh"},
    {"malformed/gltf-validator/ext/KHR_materials_clearcoat/data/material/valid_with_tangent.gltf",
     "no node has the mesh"},
    {"malformed/gltf-validator/ext/KHR_mesh_quantization/data/primitive/valid.gltf",
     "no node has the mesh"},
    {"spacecraft-gltf/iss-b-meshopt-animated.glb", "three pairs of meshes with the same data"},
};

TEST(GltfCorpus, TrianglesAreThoseOfTheValidator) {
  const std::vector<Expected> all = oracle();
  if (all.empty()) GTEST_SKIP() << "no corpus at " << corpus();
  int equal = 0;
  for (const Expected& expected : all) {
    if (expected.errors != 0 || expected.triangles < 0) continue;
    if (kOtherCount.contains(expected.path)) continue;
    DiagnosticLog log;
    Options options;
    options.textures = false;
    const auto imported = import_file(corpus() / expected.path, options, log);
    if (!imported) continue;
    EXPECT_EQ(triangles_of(imported->scene), expected.triangles) << expected.path;
    ++equal;
  }
  std::printf("files compared: %d\n", equal);
}

}  // namespace
}  // namespace panwright::importers::gltf_corpus_test
