// What is written is what is read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "base/text.h"
#include "pan/model.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::read_test {
namespace {

using layout::SectionKind;

Model load(const std::vector<std::byte>& bytes) {
  DiagnosticLog log;
  auto model = Model::from_bytes(bytes, "small.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return *std::move(model);
}

template <class T>
std::vector<double> listed(const T* values, std::size_t n) {
  return {values, values + n};
}

TEST(Read, TablesComeBack) {
  const Contents contents = support::small_contents();
  const Model model = load(write_to_memory(contents));
  ASSERT_EQ(model.nodes().size(), 3u);
  const layout::Node& body = model.nodes()[1];
  EXPECT_EQ(model.node_name(1), "body");
  EXPECT_EQ(body.parent, 0);
  EXPECT_THAT(listed(body.translation, 3), testing::ElementsAre(1, 2, 3));
  EXPECT_THAT(listed(body.rotation, 4), testing::ElementsAre(0.6, 0, 0.8, 0));
  EXPECT_THAT(listed(body.scale, 3), testing::ElementsAre(2, 2, -2));
  EXPECT_EQ(model.node_path(2), "craft/body/[2]");

  ASSERT_EQ(model.instances().size(), 3u);
  EXPECT_EQ(model.instances()[1].node, 2u);
  EXPECT_EQ(model.instances()[1].mesh, 1u);
  EXPECT_EQ(model.instances()[1].material, 1u);
  EXPECT_EQ(model.instances()[1].texture, 0);
  EXPECT_EQ(model.instances()[0].texture, -1);

  ASSERT_EQ(model.frames().size(), 1u);
  EXPECT_EQ(model.find_frame("camera"), 0u);
  EXPECT_EQ(model.find_frame("Camera"), std::nullopt);
  EXPECT_EQ(model.frames()[0].node, 1u);

  ASSERT_EQ(model.sources().size(), 3u);
  EXPECT_EQ(model.string(model.sources()[1].file), "craft.pxn");
  EXPECT_EQ(model.sources()[1].line, 9u);
  EXPECT_EQ(model.sources()[1].column, 3u);

  ASSERT_EQ(model.inputs().size(), 2u);
  EXPECT_EQ(model.string(model.inputs()[1].path), "skin.png");
  EXPECT_EQ(model.inputs()[1].hash[0], 3u);
  EXPECT_EQ(model.inputs()[1].hash[1], 4u);
  EXPECT_EQ(model.inputs()[1].bytes, 500u);
  EXPECT_EQ(model.version(), "panwright 0.1.0");
  EXPECT_EQ(model.options(), "max_error=0.001");
  EXPECT_EQ(model.string(0), "");

  ASSERT_EQ(model.textures().size(), 1u);
  EXPECT_EQ(model.texture_name(0), "skin.png");
  EXPECT_EQ(model.textures()[0].flags, layout::kTextureLinear);
  EXPECT_THAT(model.texels(0), testing::ElementsAreArray(contents.textures[0].rgba));
}

TEST(Read, NeedsKeypointsAndDecalsComeBack) {
  const Contents contents = support::small_contents();
  const Model model = load(write_to_memory(contents));
  ASSERT_TRUE(model.budget());
  EXPECT_EQ(model.budget()->tolerance, 0.5);
  EXPECT_EQ(model.budget()->nearest, 100);
  EXPECT_EQ(model.budget()->ifov, 1e-4);
  EXPECT_EQ(model.budget()->pixels, 0.25);
  EXPECT_EQ(model.budget()->flux, 0.125);
  EXPECT_EQ(model.budget()->centroid, 0.0625);
  EXPECT_EQ(model.budget()->smallest, 0.5);
  ASSERT_EQ(model.mesh_tolerances().size(), 2u);
  EXPECT_EQ(model.mesh_tolerances()[0].tolerance, 0.25);
  EXPECT_EQ(reason_name(layout::ToleranceReason{model.mesh_tolerances()[0].reason}), "flux");
  EXPECT_EQ(reason_name(layout::ToleranceReason{model.mesh_tolerances()[1].reason}),
            "explicit_counts");

  ASSERT_EQ(model.keypoints().size(), 2u);
  EXPECT_EQ(model.keypoint_name(1), "tip");
  EXPECT_EQ(model.keypoints()[1].node, 2u);
  EXPECT_THAT(listed(model.keypoints()[1].position, 3), testing::ElementsAre(0, 0, 0.1));

  ASSERT_EQ(model.sheets().size(), 1u);
  EXPECT_EQ(model.sheets()[0].mesh, 1u);
  EXPECT_EQ(model.sheets()[0].width, 2);

  ASSERT_EQ(model.decals().size(), 2u);
  EXPECT_EQ(model.decal_name(0), "flag");
  EXPECT_EQ(model.decals()[0].instance, 1u);
  EXPECT_EQ(model.decals()[1].instance, 0u);
  EXPECT_EQ(model.decals()[0].texture, 0u);
  EXPECT_EQ(model.decals()[0].width, 0.5);
  EXPECT_EQ(model.decals()[0].height, 0.25);
  EXPECT_EQ(model.decals()[1].depth, 1.5);
  // by hand: 0.6 + 0.8 k turns by 2·atan2(0.8, 0.6), so x goes to (-0.28, 0.96, 0)
  const Vec3 x(mesh_from_decal(model.decals()[0]) * Vec4(1, 0, 0, 1));
  EXPECT_NEAR(x.x, 100.5 - 0.28, 1e-13);  // residual 0: within an ulp of 100
  EXPECT_NEAR(x.y, 0.5 + 0.96, 1e-15);
  EXPECT_EQ(x.z, 7);
}

TEST(Read, NamesOfReasonsAreThoseOfTheLayout) {
  using layout::ToleranceReason;
  EXPECT_EQ(reason_name(ToleranceReason::explicit_counts), "explicit_counts");
  EXPECT_EQ(reason_name(ToleranceReason::tolerance), "tolerance");
  EXPECT_EQ(reason_name(ToleranceReason::shape), "shape");
  EXPECT_EQ(reason_name(ToleranceReason::pixels), "pixels");
  EXPECT_EQ(reason_name(ToleranceReason::flux), "flux");
  EXPECT_EQ(reason_name(ToleranceReason::centroid), "centroid");
  EXPECT_EQ(reason_name(ToleranceReason::command_line), "command_line");
}

TEST(Read, MapsComeBack) {
  Contents contents = support::small_contents();
  materials::Maps& maps = contents.materials[1].maps;
  maps.albedo = maps.normal = maps.reflectance = maps.cutout = 0;
  maps.threshold = 0.25;
  maps.repeat = {3, -0.5};
  const Model model = load(write_to_memory(contents));
  EXPECT_EQ(material_from(model.materials()[1], "").maps, maps);
  EXPECT_FALSE(material_from(model.materials()[0], "").maps.any());
}

TEST(Read, MaterialsComeBackRoundedToFloat) {
  const Contents contents = support::small_contents();
  const Model model = load(write_to_memory(contents));
  ASSERT_EQ(model.materials().size(), 2u);
  // every number of the first is a float; 0.8 of the second is not
  EXPECT_EQ(material_from(model.materials()[1], model.material_name(1)).diffuse,
            Vec3(static_cast<double>(0.8f)));
  materials::Material first = contents.materials[0];
  first.diffuse = Vec3(static_cast<double>(0.8f));
  EXPECT_EQ(material_from(model.materials()[0], model.material_name(0)), first);
  EXPECT_FALSE(material_from(model.materials()[1], "").refract);
}

TEST(Read, MeshesComeBack) {
  const Model model = load(support::small_pan());
  ASSERT_EQ(model.meshes().size(), 2u);
  EXPECT_EQ(model.mesh_name(1), "pl\u00e4t\u00e9");
  const MeshView hull = model.mesh(0), sheet = model.mesh(1);
  EXPECT_EQ(hull.positions.size(), 4u);
  EXPECT_EQ(hull.indices.size(), 12u);
  EXPECT_EQ(hull.indices[11], 2u);
  EXPECT_TRUE(hull.texcoords.empty());
  EXPECT_TRUE(hull.colors.empty());
  EXPECT_EQ(model.meshes()[0].flags, layout::kMeshClosed);
  EXPECT_EQ(model.meshes()[0].error, 0.25);  // no rounding: every coordinate is a float
  EXPECT_THAT(listed(model.meshes()[1].origin, 3), testing::ElementsAre(100.5, 0.5, 7));
  EXPECT_EQ(sheet.positions[2].x, 0.5f);
  EXPECT_EQ(sheet.positions[2].z, 0.0f);
  EXPECT_EQ(sheet.texcoords[2].y, 1.0f);
  EXPECT_EQ(sheet.colors[1].y, 1.0f);
  EXPECT_EQ(sheet.normals[0].z, 1.0f);
  EXPECT_EQ(sheet.indices.shorts.size(), 3u);
}

TEST(Read, RunsOfSeveralMeshesDoNotMix) {
  // texcoords and colours stand only where a mesh has them, so their runs begin elsewhere
  Contents contents = support::small_contents();
  contents.mesh_tolerances.clear();
  PackedMesh sheet = contents.meshes[1];
  sheet.texcoords[0] = 7;
  contents.meshes.push_back(sheet);
  sheet.colors[0] = 8;
  sheet.texcoords.clear();
  contents.meshes.push_back(sheet);
  sheet.texcoords.assign(8, 9);
  sheet.positions[0] = 0.25f;
  contents.meshes.push_back(sheet);
  const Model model = load(write_to_memory(contents));
  ASSERT_EQ(model.meshes().size(), 5u);
  EXPECT_EQ(model.mesh(1).texcoords[0].x, 0.0f);
  EXPECT_EQ(model.mesh(2).texcoords[0].x, 7.0f);
  EXPECT_TRUE(model.mesh(3).texcoords.empty());
  EXPECT_EQ(model.mesh(4).texcoords[0].x, 9.0f);
  EXPECT_EQ(model.mesh(2).colors[0].x, 1.0f);
  EXPECT_EQ(model.mesh(3).colors[0].x, 8.0f);
  EXPECT_EQ(model.mesh(4).positions[0].x, 0.25f);
  EXPECT_EQ(model.mesh(4).indices[2], 2u);
}

TEST(Read, WorldMatricesMultiplyDownTheTree) {
  const Model model = load(support::small_pan());
  const std::vector<Mat4> world = model.world_from_nodes();
  // by hand: 0.6 + 0.8 j turns by 2·atan2(0.8, 0.6): x → -0.28 x - 0.96 z, z → 0.96 x - 0.28 z;
  // node 2 is turned half round about x and lies at z = 1e5 of a node scaled by 2 2 -2
  const Vec4 p = world[2] * Vec4(1, 1, 1, 1);
  // in node 1: (1, -1, 1e5 - 1); scaled: (2, -2, -2e5 + 2)
  const double x = 2, y = -2, z = -2e5 + 2;
  // residual 2.9e-11 of 2e5: the quaternion's products are rounded
  EXPECT_NEAR(p.x, 1 + (-0.28 * x + 0.96 * z), 1e-9);
  EXPECT_NEAR(p.y, 2 + y, 1e-9);
  EXPECT_NEAR(p.z, 3 + (-0.96 * x - 0.28 * z), 1e-9);
  EXPECT_EQ(p.w, 1);
  const Mat4 camera = model.world_from_frame(0);
  EXPECT_EQ(Vec3(camera[3]), Vec3(world[1] * Vec4(0, 0, 0.5, 1)));
}

TEST(Read, WorldBoundsHoldTheFurthestVertices) {
  Contents contents = support::small_contents();
  contents.instances.resize(1);
  contents.sources.resize(1);
  contents.decals.clear();
  contents.levels.clear();
  contents.nodes[1].rotation = {1, 0, 0, 0};
  const Model model = load(write_to_memory(contents));
  const auto bounds = model.world_bounds();
  ASSERT_TRUE(bounds);
  EXPECT_EQ(bounds->low, Vec3(-1, 0, 1));
  EXPECT_EQ(bounds->high, Vec3(3, 4, 5));
  contents.instances.clear();
  contents.sources.clear();
  EXPECT_FALSE(load(write_to_memory(contents)).world_bounds());
}

TEST(Read, UnknownOptionalSectionsAreIgnored) {
  support::OpenPan file(support::small_pan());
  file.add_section(1000, true, 1, std::vector<std::byte>(128, std::byte{7}));
  file.add_section(0, true, 64, std::vector<std::byte>(64));
  file.header().optional_features = ~0ull;
  file.header().minor = 3;
  file.seal();
  const Model model = load(file.bytes());
  EXPECT_EQ(model.directory().size(), support::kSampleSections + 2);
  EXPECT_EQ(model.meshes().size(), 2u);
}

TEST(Read, DamageInAnUnknownSectionIsFound) {
  support::OpenPan file(support::small_pan());
  file.add_section(1000, true, 1, std::vector<std::byte>(128, std::byte{7}));
  file.seal();
  std::vector<std::byte> bytes = file.bytes();
  bytes[file.entry(support::kSampleSections).offset + 100] ^= std::byte{1};
  DiagnosticLog log;
  auto model = Model::from_bytes(bytes, "x", log);
  ASSERT_TRUE(model);
  EXPECT_FALSE(model->check(log));
  EXPECT_TRUE(log.contains(Code("E4009")));
}

TEST(Read, FilesAreMappedAndRead) {
  const auto path = std::filesystem::temp_directory_path() / "panwright_read_test.pan";
  DiagnosticLog log;
  ASSERT_TRUE(write(support::small_contents(), path, log)) << to_text(log);
  auto mapped = Model::load(path, log);
  ASSERT_TRUE(mapped) << to_text(log);
  auto read = Model::read(path, 1 << 20, log);
  ASSERT_TRUE(read && read->check(log));
  EXPECT_TRUE(std::ranges::equal(mapped->bytes(), read->bytes()));
  EXPECT_FALSE(Model::read(path, 1000, log));
  EXPECT_TRUE(log.contains(Code("E0104")));
  const Model moved = *std::move(mapped);
  EXPECT_EQ(moved.node_name(1), "body");
  std::filesystem::remove(path);
  EXPECT_FALSE(Model::open(path, log));
  EXPECT_TRUE(log.contains(Code("E0101")));
}

TEST(Read, MinimalModel) {
  Contents contents;
  contents.nodes = {{"root"}};
  const Model model = load(write_to_memory(contents));
  EXPECT_EQ(model.nodes().size(), 1u);
  EXPECT_TRUE(model.meshes().empty());
  EXPECT_TRUE(model.sources().empty());
  EXPECT_FALSE(model.entry(SectionKind::sources));
  EXPECT_FALSE(model.budget());
  EXPECT_TRUE(model.mesh_tolerances().empty());
  EXPECT_TRUE(model.keypoints().empty());
  EXPECT_TRUE(model.decals().empty());
}

TEST(Read, WideIndicesFromTheFirstVertexThatNeedsThem) {
  for (const std::size_t count : {65535u, 65536u}) {
    Contents contents;
    contents.nodes = {{"root"}};
    geometry::Mesh mesh;
    for (std::size_t i = 0; i < count; ++i) mesh.positions.emplace_back(i, i % 7, 0);
    mesh.normals.assign(count, {0, 0, 1});
    const auto last = static_cast<std::uint32_t>(count - 1);
    mesh.triangles = {{0, 1, last}};
    contents.meshes = {packed(mesh, "")};
    const Model model = load(write_to_memory(contents));
    EXPECT_EQ(model.meshes()[0].index_size, count == 65535 ? 2u : 4u);
    EXPECT_EQ(model.mesh(0).indices[2], last);
  }
}

}  // namespace
}  // namespace panwright::pan::read_test
