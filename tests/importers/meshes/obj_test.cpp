// OBJ: what becomes of its words, and what is said of wrong ones.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/importers/meshes/mesh_files.h"

namespace panwright::importers::obj_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

std::unique_ptr<MeshReading> read_obj(const std::string& text, const std::string& mtl = {}) {
  std::vector<MemoryFile> files = {{"m.obj", text}};
  if (!mtl.empty()) files.push_back({"m.mtl", mtl});
  return read_meshes(files);
}

TEST(Obj, ObjectsAndGroupsAreNodes) {
  const auto out = read_obj(kSquare +
                            "f 1 2 3\no bus\nf 1 2 3\ng left side\nf 1 3 4\ng right/2\nf 1 2 4\n"
                            "g left side\nf 2 3 4\no boom\nf 1 2 3\n");
  ASSERT_TRUE(out->out) << out->text();
  ASSERT_EQ(out->scene().instances.size(), 5u);
  EXPECT_EQ(out->path(0), "/mesh1");
  EXPECT_EQ(out->path(1), "/bus");
  EXPECT_EQ(out->path(2), "/bus/left side");
  EXPECT_EQ(out->path(3), "/bus/right_2");
  EXPECT_EQ(out->path(4), "/boom");
  // a group that comes again goes on
  EXPECT_EQ(out->mesh(2).triangles.size(), 2u);
  EXPECT_EQ(out->scene().nodes[2].source.line, 6u);
  EXPECT_THAT(out->log.entries(), IsEmpty()) << out->text();
}

TEST(Obj, OneShapeForEachGroupAndMaterial) {
  const auto out = read_obj("mtllib m.mtl\n" + kSquare +
                                "g a\nusemtl red one\nf 1 2 3\nusemtl blue\nf 1 3 4\n"
                                "usemtl red one\nf 2 3 4\ng b\nf 1 2 4\n",
                            "newmtl red one\nKd 1 0 0\nnewmtl blue\nKd 0 0 0.5\n");
  ASSERT_TRUE(out->out) << out->text();
  ASSERT_EQ(out->scene().instances.size(), 3u);
  EXPECT_EQ(out->mesh(0).triangles.size(), 2u);
  EXPECT_EQ(out->material(0).name, "red one");
  EXPECT_EQ(out->material(1).diffuse, Vec3(0, 0, 0.5));
  EXPECT_EQ(out->path(1), "/a");
  EXPECT_EQ(out->path(2), "/b");
  EXPECT_EQ(out->scene().instances[0].material, out->scene().instances[2].material);
  EXPECT_EQ(out->scene().materials.size(), 2u);
  ASSERT_EQ(out->scene().inputs.size(), 2u);
  EXPECT_EQ(out->scene().inputs[1].path, "m.mtl");
}

TEST(Obj, IndicesCountFromBothEnds) {
  const auto a = read_obj(kSquare + "f 1 2 3 4\n");
  const auto b = read_obj(kSquare + "f -4 -3 -2 -1\n");
  const auto c = read_obj("f 1 2 3 4\n" + kSquare);  // what comes later counts as well
  ASSERT_TRUE(a->out && b->out && c->out);
  EXPECT_EQ(a->mesh().positions, b->mesh().positions);
  EXPECT_EQ(a->mesh().triangles, b->mesh().triangles);
  EXPECT_EQ(a->mesh().triangles, c->mesh().triangles);
}

TEST(Obj, CornersHaveTexcoordsAndNormals) {
  const auto out = read_obj(kSquare +
                            "vt 0 0\nvt 1 0\nvt 1 1\nvt 0.5\nvn 0 0 2\nvn 1 0 0\n"
                            "f 1/1/1 2/2/1 3/3/1 4/4/1\nf 1//2 2//2 3//2\nf 2/2 3/3 4/4\n");
  ASSERT_TRUE(out->out) << out->text();
  const geometry::Mesh& mesh = out->mesh();
  ASSERT_EQ(mesh.triangles.size(), 4u);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
  // four corners, three with the second normal, three without
  EXPECT_EQ(mesh.positions.size(), 10u);
  EXPECT_EQ(mesh.normals[0], Vec3(0, 0, 1));
  EXPECT_EQ(mesh.texcoords[3], Vec2(0.5, 0));
  EXPECT_EQ(mesh.normals[4], Vec3(1, 0, 0));
  EXPECT_EQ(mesh.normals[7], Vec3(0, 0, 1));
  EXPECT_THAT(out->text(), HasSubstr("W6502"));  // the middle face has no texcoords
}

TEST(Obj, VerticesHaveColors) {
  const auto out = read_obj("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 0.25\nf 1 2 3\n");
  ASSERT_TRUE(out->out);
  EXPECT_THAT(out->mesh().colors, ElementsAre(Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 0.25)));
  EXPECT_EQ(out->material(0).diffuse, Vec3(1));
}

TEST(Obj, SmoothingGroupsShareNormalsWithinThemselves) {
  // a roof of two squares that meet at 90 degrees along the x axis
  const std::string roof = "v 0 0 0\nv 1 0 0\nv 1 1 -1\nv 0 1 -1\nv 1 -1 -1\nv 0 -1 -1\n";
  const std::string left = "f 1 2 3 4\n", right = "f 2 1 6 5\n";
  const auto one = read_obj(roof + "s 1\n" + left + right);
  const auto two = read_obj(roof + "s 1\n" + left + "s 2\n" + right);
  const auto off = read_obj(roof + "s off\n" + left + right);
  const auto none = read_obj(roof + left + right);
  ASSERT_TRUE(one->out && two->out && off->out && none->out);
  EXPECT_EQ(one->mesh().positions.size(), 6u);
  EXPECT_LT(glm::length(one->mesh().normals[0] - Vec3(0, 0, 1)), 1e-15);  // measured 0
  EXPECT_EQ(two->mesh().positions.size(), 8u);
  EXPECT_EQ(off->mesh().positions.size(), 8u);
  EXPECT_EQ(none->mesh().positions.size(), 8u);
  // a blunt ridge is smooth where the file does not say, and where it says what Blender says always
  std::string blunt = roof;
  for (std::size_t at; (at = blunt.find(" -1\n")) != blunt.npos;) blunt.replace(at, 4, " -0.1\n");
  EXPECT_EQ(read_obj(blunt + left + right)->mesh().positions.size(), 6u);
  EXPECT_EQ(read_obj(blunt + "s off\n" + left + right)->mesh().positions.size(), 6u);
  EXPECT_EQ(read_obj(blunt + "s 1\n" + left + "s 2\n" + right)->mesh().positions.size(), 8u);
}

TEST(Obj, MaterialsAreThoseOfVrml) {
  const auto out =
      read_obj("mtllib m.mtl\n" + kSquare +
                   "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\nusemtl d\nf 1 2 3\n",
               "newmtl a\nKd 0.1 0.2 0.3\nKs 0.4 0.5 0.6\nNs 32\nillum 2\nKe 0 0 0.5\nd 0.25\n"
               "newmtl b\nKd 0.5\nKs 1 1 1\nNs 10\nillum 1\nTr 0.25\n"
               "newmtl c\nKs 1 1 1\nNs 500\nPr 0.3\nPm 1\nmap_Bump x.png\n"
               "newmtl d\n");
  ASSERT_TRUE(out->out) << out->text();
  const materials::Material& a = out->material(0);
  EXPECT_EQ(a.diffuse, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(a.specular_model(), materials::SpecularModel::blinn_phong);
  EXPECT_EQ(a.specular, Vec3(0.4, 0.5, 0.6));
  EXPECT_EQ(std::get<materials::BlinnPhong>(a.specular_brdf).shine, 32);
  EXPECT_EQ(a.weights, Vec3(1, 1, 1));
  EXPECT_EQ(out->out->materials[0].opacity, 0.25);
  EXPECT_EQ(out->material(1).diffuse, Vec3(0.5));
  EXPECT_EQ(out->material(1).specular_model(), materials::SpecularModel::none);
  EXPECT_EQ(out->out->materials[1].opacity, 0.75);
  EXPECT_EQ(std::get<materials::BlinnPhong>(out->material(2).specular_brdf).shine, 128);
  EXPECT_EQ(out->out->materials[2].metallic, 1);
  EXPECT_EQ(out->out->materials[2].roughness, 0.3);
  EXPECT_EQ(out->material(3).diffuse, Vec3(0.8));
  EXPECT_TRUE(out->log.contains(Code("W6008")));
  for (const char* what : {"opacity", "'a' (0.25), 'b' (0.75)", "bump map", "shininess over 128"})
    EXPECT_THAT(out->text(), HasSubstr(what));
}

TEST(Obj, TexturesAreLaidOnTexcoords) {
  const std::string texture("P6\n1 1\n255\n\x10\x20\x30", 14);
  const std::string square = kSquare + "vt 0 0\nvt 1 0\nvt 1 1\nusemtl a\n";
  const auto out = read_meshes(
      {{"models/m.obj", "mtllib parts/m.mtl\n" + square + "f 1/1 2/2 3/3\ng bare\nf 1 2 3\n"},
       {"models/parts/m.mtl", "newmtl a\nKd 0 0 0\nmap_Kd -s 2 3 1 -clamp on a texture.ppm\n"},
       {"models/parts/a texture.ppm", texture}});
  ASSERT_TRUE(out->out) << out->text();
  ASSERT_EQ(out->scene().textures.size(), 1u);
  EXPECT_EQ(out->material(0).maps.albedo, 0);
  EXPECT_EQ(out->material(0).maps.repeat, Vec2(2, 3));
  EXPECT_EQ(out->material(0).diffuse, Vec3(1));  // black under a texture is not meant
  EXPECT_TRUE(out->log.contains(Code("W6502")));
  EXPECT_EQ(out->material(1).maps.albedo, -1);
  EXPECT_EQ(out->scene().inputs.size(), 3u);
  Options none;
  none.textures = false;
  EXPECT_TRUE(read_meshes(out->files, none)->scene().textures.empty());
}

TEST(Obj, MissingFilesAreNamed) {
  const auto out =
      read_obj("mtllib none.mtl\nmtllib ../out.mtl\n" + kSquare + "usemtl a\nf 1 2 3\n");
  ASSERT_TRUE(out->out);
  EXPECT_THAT(out->places(), ElementsAre("1:8 W6004", "2:8 W6005"));
  EXPECT_EQ(out->material(0).name, "a");  // rules by name still find it
}

TEST(Obj, LibrariesMayStandAnywhere) {
  const std::string faces = kSquare + "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n";
  for (const std::string& text :
       {"mtllib m.mtl\n" + faces, faces + "mtllib m.mtl\n",
        kSquare + "usemtl a\nf 1 2 3\nmtllib m.mtl\nusemtl b\nf 1 3 4\n"}) {
    const auto out = read_obj(text, "newmtl b\nKd 0 1 0\nnewmtl a\nKd 1 0 0\n");
    ASSERT_TRUE(out->out);
    EXPECT_THAT(out->places(), testing::IsEmpty()) << out->text();
    EXPECT_EQ(out->material(0).diffuse, Vec3(1, 0, 0));
    EXPECT_EQ(out->material(1).diffuse, Vec3(0, 1, 0));
  }
}

// Values of other programs that no material has are clamped, and are no errors.
TEST(Obj, MaterialsOutOfRangeAreClampedAndSaid) {
  for (const char* line : {"Pr -0.13", "Pm 1.2", "Kd 1.5 0 0", "Ks 0 -1 0", "d 1.01", "Ns -3",
                           "Kd nan 0 0", "Pr -inf", "Ks 1.#IND 0 0"}) {
    const auto out = read_obj("mtllib m.mtl\n" + kSquare + "usemtl a\nf 1 2 3\n",
                              "newmtl a\n" + std::string(line) + "\n");
    ASSERT_TRUE(out->out);
    EXPECT_FALSE(out->log.has_errors()) << out->text();
    EXPECT_THAT(out->text(), HasSubstr("values outside of 0 to 1")) << line;
    const CadMaterial& cad = out->out->materials[0];
    EXPECT_TRUE(cad.roughness >= 0 && cad.metallic <= 1 && cad.opacity <= 1) << line;
  }
}

// as Windows' editors save it
TEST(Obj, Utf16IsRead) {
  const auto wide = [](const std::string& text, bool big) {
    std::string out = big ? "\xfe\xff" : "\xff\xfe";
    for (const char c : text) out.append(big ? std::string{'\0', c} : std::string{c, '\0'});
    return out;
  };
  for (const bool big : {false, true}) {
    const auto out = read_obj(wide("mtllib m.mtl\n" + kSquare + "o bus\nusemtl a\nf 1 2 3\n", big),
                              wide("newmtl a\nKd 1 0 0\n", !big));
    ASSERT_TRUE(out->out) << out->text();
    EXPECT_EQ(out->path(0), "/bus");
    EXPECT_EQ(out->material(0).diffuse, Vec3(1, 0, 0));
    EXPECT_THAT(out->log.entries(), IsEmpty()) << out->text();
  }
}

TEST(Obj, AnUnknownMaterialHasItsNearestName) {
  const auto out = read_obj("mtllib m.mtl\n" + kSquare + "usemtl Alumnium\nf 1 2 3\nf 1 3 4\n",
                            "newmtl Aluminium\nKd 1 0 0\n");
  ASSERT_TRUE(out->out);
  EXPECT_THAT(out->places(), ElementsAre("6:8 W6502"));
  EXPECT_THAT(out->text(), HasSubstr("did you mean 'Aluminium'?"));
}

TEST(Obj, WhatMakesNoSurfaceIsCounted) {
  const auto out = read_obj(kSquare + "f 1 2 3\nl 1 2 3\nl 2 3\np 1\ncstype bezier\ndeg 3\nend\n");
  ASSERT_TRUE(out->out);
  EXPECT_THAT(out->text(), HasSubstr("skipped: free-form statement (3), line (2), point"));
  EXPECT_FALSE(out->log.has_errors());
}

TEST(Obj, WrongLinesCostNothingElse) {
  const auto out = read_obj(kSquare +
                            "v 1 x 3\n"        // 5
                            "v 1 2\n"          // 6
                            "v inf 0 0\n"      // 7
                            "f 1 2 3\n"        // 8
                            "f 1 2 99\n"       // 9
                            "f 1 2 0\n"        // 10
                            "f 1 2 5\n"        // 11
                            "f 1 2 3/9/9\n"    // 12
                            "f 1 -99 2\n"      // 13
                            "f 1 2\n"          // 14
                            "f 1 2 3 # end\n"  // 15
                            "quad 1 2 3\n"     // 16
                            "s many\n");       // 17
  ASSERT_TRUE(out->out) << out->text();
  EXPECT_THAT(out->places(),
              ElementsAre("5:5 E6501", "6:2 E6501", "10:7 E6501", "14:2 W6502", "16:1 E6501",
                          "17:3 W6502", "9:1 E6501", "11:1 E6501", "12:1 E6501", "12:1 E6501"));
  EXPECT_EQ(out->mesh().triangles.size(), 3u);
  EXPECT_THAT(out->text(), HasSubstr("1 more like this one"));
}

TEST(Obj, LinesMayBeJoinedAndEndInAnyWay) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string text = kSquare + "f 1 2 \\\n3 \\\n4\n";
    for (std::size_t at = 0; (at = text.find('\n', at)) != text.npos; at += end.size())
      text.replace(at, 1, end);
    const auto out = read_obj("\xef\xbb\xbf" + text);
    ASSERT_TRUE(out->out) << out->text();
    EXPECT_EQ(out->mesh().triangles.size(), 2u);
    EXPECT_THAT(out->log.entries(), IsEmpty()) << out->text();
  }
}

TEST(Obj, ManySmoothingGroupsAndGroupsTakeTheirTime) {
  // each costs what its own faces cost
  std::string text = kSquare;
  for (int i = 0; i < 20000; ++i) text += fmt::format("g a{}\ns {}\nf 1 2 3\n", i % 5000, i + 1);
  const auto out = read_obj(text);
  ASSERT_TRUE(out->out) << out->text();
  EXPECT_EQ(out->scene().instances.size(), 5000u);
  EXPECT_EQ(out->mesh(0).triangles.size(), 4u);
  EXPECT_EQ(out->mesh(0).positions.size(), 12u);
}

TEST(Obj, ManyUnknownNamesTakeTheirTime) {
  std::string text = "mtllib m.mtl\nmtllib a b\n" + kSquare, library = "newmtl known\n";
  for (int i = 0; i < 50000; ++i) {
    text += fmt::format("usemtl unknown{}\nmtllib a b\n", i);
    library += fmt::format("property{} 1\n", i);
  }
  const auto out = read_meshes(
      {{"m.obj", text + "usemtl known\nf 1 2 3\n"}, {"m.mtl", library}, {"a b", "newmtl other\n"}});
  ASSERT_TRUE(out->out);
  EXPECT_EQ(out->log.warnings(), 50001u);  // and what is lost
  EXPECT_EQ(out->out->materials[0].lost.size(), 30u);
  EXPECT_LT(out->text().size(), 1u << 20);
}

}  // namespace
}  // namespace panwright::importers::obj_test
