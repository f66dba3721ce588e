// Materials assigned to CAD parts, and what stays of the part's own colours and textures.
#include <fmt/core.h>

#include "tests/pxn/reading.h"

namespace panwright::pxn::assign_test {
namespace {

// A plate with a colour at each vertex, on two nodes.
constexpr const char* kColored = R"(#VRML V2.0 utf8
DEF a Transform { children Shape { appearance Appearance { material DEF Red Material { } }
  geometry DEF Plate IndexedFaceSet {
    coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } coordIndex [ 0 1 2 3 ]
    color Color { color [ 1 0 0, 0 1 0, 0 0 1, 1 1 1 ] } colorPerVertex TRUE } } }
DEF b Transform { translation 3 0 0 children
  Shape { appearance Appearance { material DEF Blue Material { } } geometry USE Plate } }
)";

Reading dressed(const std::string& rule, int times = 1) {
  return read_files(
      {{"top.pxn",
        fmt::format("<pangu_model ver=\"1\"><material name=\"metal\" preset=\"aluminium_bare\"/>"
                    "<repeat count=\"{}\"><import file=\"p.wrl\" translate=\"0 {{i}} 0\">{}"
                    "</import></repeat></pangu_model>",
                    times, rule)},
       {"p.wrl", kColored}});
}

const geometry::Mesh& mesh_of(const Reading& r, const scene::Instance& instance) {
  return *std::get<geometry::MeshShape>(r.scene->shapes[static_cast<std::size_t>(instance.shape)]);
}

const std::string& material_of(const Reading& r, const scene::Instance& instance) {
  return r.scene->materials[static_cast<std::size_t>(instance.material)].name;
}

TEST(Assign, VertexColorsGoWithTheTextures) {
  const Reading r = dressed("<assign materials=\"Red\" material=\"metal\"/>", 3);
  EXPECT_EQ(r.summary(), "");
  ASSERT_EQ(r.scene->instances.size(), 6u);
  std::set<std::int32_t> shapes;
  for (const scene::Instance& instance : r.scene->instances) {
    const geometry::Mesh& mesh = mesh_of(r, instance);
    const bool assigned = material_of(r, instance) == "metal";
    // the other part shares the mesh, and keeps its colours
    EXPECT_EQ(mesh.colors.empty(), assigned) << material_of(r, instance);
    EXPECT_EQ(mesh.triangles.size(), 2u);
    shapes.insert(instance.shape);
  }
  EXPECT_EQ(shapes.size(), 2u) << "one copy, however often it stands there";
}

TEST(Assign, KeptTexturesKeepVertexColors) {
  const Reading r = dressed("<assign materials=\"Red\" material=\"metal\" pictures=\"keep\"/>");
  ASSERT_EQ(r.scene->instances.size(), 2u);
  for (const scene::Instance& instance : r.scene->instances)
    EXPECT_FALSE(mesh_of(r, instance).colors.empty());
}

TEST(Assign, PartsWithoutARuleKeepTheirColors) {
  const Reading r = dressed("");
  ASSERT_EQ(r.scene->instances.size(), 2u);
  for (const scene::Instance& instance : r.scene->instances)
    EXPECT_FALSE(mesh_of(r, instance).colors.empty());
}

}  // namespace
}  // namespace panwright::pxn::assign_test
