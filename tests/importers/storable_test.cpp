// What import writes, the pan reader reads: files at the edge of what a pan can hold.
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "compiler/compile.h"
#include "importers/import.h"
#include "pan/model.h"

namespace panwright::importers::storable_test {
namespace {

struct Case {
  const char* path;
  std::string text;
  Code code;
  std::size_t instances;
};

TEST(Storable, whatImportKeepsThePanReaderTakes) {
  const std::string vrml = "#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { ";
  const std::string gltf =
      R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"name":"a\u0000b"}],)"
      R"("materials":[{"name":"x\u0000y"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},)"
      R"("material":0}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",)"
      R"("min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[)"
      R"({"byteLength":36,"uri":"data:application/octet-stream;base64,)"
      R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
  const Case cases[] = {
      {"one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 1 1\n", Code("W6009"), 0},
      {"two.obj", "v 0 0 0\nv 1 0 0\nf 1 2 1\n", Code("W6009"), 0},
      {"two.wrl", vrml + "coord Coordinate { point [0 0 0, 1 0 0] } coordIndex [0 1 0 -1] } }",
       Code("W6009"), 0},
      {"two.stl",
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 0\n"
       "endloop\nendfacet\nendsolid a\n",
       Code("W6009"), 0},
      {"two.ply",
       "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
       "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
       "0 0 0\n1 0 0\n3 0 1 0\n",
       Code("W6009"), 0},
      {"far.wrl",
       vrml + "coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } coordIndex [0 1 2 -1] "
              "texCoord TextureCoordinate { point [1e39 0, 0 1, 1 1] } } }",
       Code("W6012"), 1},
      {"nul.gltf", gltf, Code("W6012"), 1},
  };
  for (const Case& each : cases) {
    DiagnosticLog log;
    const MemoryFile files[] = {{each.path, each.text}};
    const auto imported = import_memory(files, {}, log);
    ASSERT_TRUE(imported) << each.path << '\n' << to_text(log);
    EXPECT_TRUE(log.contains(each.code)) << each.path << '\n' << to_text(log);
    EXPECT_EQ(imported->scene.instances.size(), each.instances) << each.path;
    EXPECT_EQ(scene::check(imported->scene), "") << each.path;
    DiagnosticLog compiled_log;
    const auto bytes = compiler::compiled(imported->scene, {}, compiled_log);
    ASSERT_TRUE(bytes) << each.path << '\n' << to_text(compiled_log);
    DiagnosticLog read_log;
    EXPECT_TRUE(pan::Model::from_bytes(*bytes, each.path, read_log)) << each.path << '\n'
                                                                     << to_text(read_log);
  }
}

// Of a library that has no images too.
TEST(Storable, repeatsOfTexturesFitSinglePrecision) {
  const MemoryFile files[] = {
      {"m.obj",
       "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
       "f 1/1 2/2 3/3\n"},
      {"m.mtl", "newmtl a\nKd 1 1 1\nmap_Kd -s 1e39 1 1 t.ppm\n"},
      {"t.ppm", std::string("P6\n1 1\n255\n\xff\xff\xff", 14)}};
  DiagnosticLog log;
  const auto imported = import_memory(files, {}, log);
  ASSERT_TRUE(imported) << to_text(log);
  EXPECT_TRUE(log.contains(Code("W6012"))) << to_text(log);
  const auto bytes = compiler::compiled(imported->scene, {}, log);
  ASSERT_TRUE(bytes) << to_text(log);
  auto model = pan::Model::from_bytes(*bytes, "m.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
}

}  // namespace
}  // namespace panwright::importers::storable_test
