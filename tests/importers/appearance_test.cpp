// Opacity, energy and normal maps, alike in all formats.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "compiler/hidden.h"
#include "tests/importers/gltf/sample.h"
#include "tests/importers/meshes/mesh_files.h"

namespace panwright::importers::appearance_test {
namespace {

using testing::HasSubstr;

std::size_t count(const DiagnosticLog& log, Code code) {
  std::size_t n = 0;
  for (const Diagnostic& entry : log.entries()) n += entry.code == code ? 1 : 0;
  return n;
}

// Whether all diagnostics of a code stand at an element: behind the begin of a text, or at a JSON
// pointer.
bool is_placed(const DiagnosticLog& log, Code code) {
  return std::ranges::all_of(log.entries(), [&](const Diagnostic& entry) {
    return entry.code != code ||
           (entry.where.file != kNoFile && (entry.where.begin > 0 || !entry.object.empty()));
  });
}

// A solid part, and one of an opacity between 0 and 1, whose text is the argument of `make`.
struct OpacityFormat {
  const char* name;
  std::vector<MemoryFile> (*make)(const std::string& opacity);
};

std::string one_less(const std::string& opacity) {
  return fmt::format("{:g}", 1 - *parse_double(opacity));
}

const std::string kBox = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

const OpacityFormat kOpacityFormats[] = {
    {"MTL, d",
     [](const std::string& opacity) {
       return std::vector<MemoryFile>{
           {"m.obj", "mtllib m.mtl\n" + kBox + "usemtl bus\nf 1 2 3\nusemtl dome\nf 1 2 4\n"},
           {"m.mtl", "newmtl bus\nKd 1\nnewmtl dome\nKd 1\nd " + opacity + "\n"}};
     }},
    {"MTL, Tr",
     [](const std::string& opacity) {
       return std::vector<MemoryFile>{
           {"m.obj", "mtllib m.mtl\n" + kBox + "usemtl bus\nf 1 2 3\nusemtl dome\nf 1 2 4\n"},
           {"m.mtl", "newmtl bus\nKd 1\nnewmtl dome\nKd 1\nTr " + one_less(opacity) + "\n"}};
     }},
    {"VRML 97",
     [](const std::string& opacity) {
       return std::vector<MemoryFile>{
           {"m.wrl",
            "#VRML V2.0 utf8\nShape { geometry Box {} }\nShape { appearance Appearance { material "
            "DEF dome Material { transparency " +
                one_less(opacity) + " } } geometry Sphere {} }"}};
     }},
    {"VRML 1.0",
     [](const std::string& opacity) {
       return std::vector<MemoryFile>{
           {"m.wrl", "#VRML V1.0 ascii\nSeparator { Cube {} DEF dome Material { transparency " +
                         one_less(opacity) + " } Sphere {} }"}};
     }},
    {"URDF",
     [](const std::string& opacity) {
       return std::vector<MemoryFile>{
           {"m.urdf",
            "<robot name=\"r\"><link name=\"a\"><visual><geometry><box size=\"1 1 1\"/></geometry>"
            "</visual><visual><geometry><sphere radius=\"2\"/></geometry><material name=\"dome\">"
            "<color rgba=\"1 1 1 " +
                opacity + "\"/></material></visual></link></robot>"}};
     }},
    {"MJCF",
     [](const std::string& opacity) {
       return std::vector<MemoryFile>{
           {"m.xml", "<mujoco><asset><material name=\"dome\" rgba=\"1 1 1 " + opacity +
                         "\"/></asset><worldbody><geom size=\"1\"/><geom size=\"2\" "
                         "material=\"dome\"/></worldbody></mujoco>"}};
     }},
    {"glTF",
     [](const std::string& opacity) {
       Sample sample = triangle();
       sample.json["materials"] = {
           {{"name", "dome"},
            {"alphaMode", "BLEND"},
            {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, *parse_double(opacity)}}}}}};
       sample.json["meshes"].push_back(sample.json["meshes"][0]);
       sample.json["meshes"][1]["primitives"][0]["material"] = 0;
       sample.json["nodes"].push_back({{"mesh", 1}});
       sample.json["scenes"][0]["nodes"] = {0, 1};
       return std::vector<MemoryFile>{{"m.glb", sample.glb()}};
     }},
};

TEST(Opacity, PartsOfNoneAreLeftOutAndNamed) {
  for (const OpacityFormat& format : kOpacityFormats) {
    SCOPED_TRACE(format.name);
    const auto reading = read_meshes(format.make("0"));
    ASSERT_TRUE(reading->out) << reading->text();
    EXPECT_EQ(reading->scene().instances.size(), 1u) << reading->text();
    EXPECT_THAT(reading->text(), HasSubstr("left out"));
    EXPECT_EQ(count(reading->log, Code("W6008")), 0u) << reading->text();
  }
}

TEST(Opacity, PartlyTransparentMaterialsAreNamedOnceAndHideNothing) {
  for (const OpacityFormat& format : kOpacityFormats) {
    SCOPED_TRACE(format.name);
    const auto reading = read_meshes(format.make("0.25"));
    ASSERT_TRUE(reading->out) << reading->text();
    ASSERT_EQ(reading->scene().instances.size(), 2u);
    EXPECT_EQ(count(reading->log, Code("W6008")), 1u) << reading->text();
    EXPECT_THAT(reading->text(), HasSubstr("'dome' (0.25)"));
    EXPECT_TRUE(is_placed(reading->log, Code("W6008"))) << reading->text();
    EXPECT_FALSE(reading->scene().instances[0].see_through);
    EXPECT_TRUE(reading->scene().instances[1].see_through);
    const auto solid = read_meshes(format.make("1"));
    ASSERT_TRUE(solid->out);
    EXPECT_FALSE(solid->scene().instances.at(1).see_through);
    EXPECT_EQ(count(solid->log, Code("W6008")), 0u) << solid->text();
  }
}

// A box in a closed shell: hidden by a solid one alone.
TEST(Opacity, WhatStandsInAShellStays) {
  for (const double opacity : {1.0, 0.05}) {
    const auto reading = read_meshes(
        {{"m.wrl",
          "#VRML V2.0 utf8\nShape { geometry Box { size .1 .1 .1 } }\nShape { appearance "
          "Appearance { material Material { transparency " +
              fmt::format("{}", 1 - opacity) + " } } geometry Box {} }"}});
    ASSERT_TRUE(reading->out);
    scene::Scene scene = reading->scene();
    DiagnosticLog log;
    const auto report = compiler::prune_hidden(scene, {}, log);
    ASSERT_TRUE(report) << to_text(log);
    EXPECT_EQ(scene.instances.size(), opacity < 1 ? 2u : 1u);
  }
}

// MeshLab writes Tr 1 into every material, and means opaque ones.
TEST(Opacity, TrOfMeshLabIsOpacity) {
  const std::string obj = "mtllib m.mtl\n" + kBox + "usemtl a\nf 1 2 3\n";
  for (const char* mtl : {"# Converted by MeshLab Group\nnewmtl a\nTr 1\nnewmtl b\nTr 0.5\n",
                          "newmtl a\nKd 1\nTr 1\n"}) {
    const auto reading = read_meshes({{"m.obj", obj}, {"m.mtl", mtl}});
    ASSERT_TRUE(reading->out) << reading->text();
    EXPECT_EQ(reading->scene().instances.size(), 1u);
    EXPECT_EQ(reading->out->materials[0].opacity, 1);
    EXPECT_EQ(count(reading->log, Code("W6502")), 1u) << reading->text();
  }
}

// ---- energy

TEST(Energy, DiffuseAndSpecularAreScaledToOne) {
  const std::vector<std::vector<MemoryFile>> cases = {
      {{"m.obj", "mtllib m.mtl\n" + kBox + "usemtl a\nf 1 2 3\n"},
       {"m.mtl", "newmtl a\nKd 0.9 0.6 0.3\nKs 0.6 0.6 0.6\nNs 20\n"}},
      {{"m.wrl",
        "#VRML V2.0 utf8\nShape { appearance Appearance { material DEF a Material { diffuseColor "
        ".9 .6 .3 specularColor .6 .6 .6 } } geometry Box {} }"}},
      {{"m.wrl",
        "#VRML V1.0 ascii\nSeparator { DEF a Material { diffuseColor .9 .6 .3 specularColor .6 .6 "
        ".6 } Cube {} }"}},
  };
  for (const std::vector<MemoryFile>& files : cases) {
    const auto reading = read_meshes(files);
    ASSERT_TRUE(reading->out) << reading->text();
    const materials::Material& m = reading->material(0);
    // the largest sum, of red, was 1.5; the hue of both parts stays
    EXPECT_LT(glm::length(m.diffuse - Vec3(0.6, 0.4, 0.2)), 1e-15) << files[0].path;
    EXPECT_LT(glm::length(m.specular - Vec3(0.4)), 1e-15);
    EXPECT_EQ(count(reading->log, Code("W1402")), 1u) << reading->text();
    EXPECT_THAT(reading->text(), HasSubstr("'a' (1.5)"));
    EXPECT_TRUE(is_placed(reading->log, Code("W1402"))) << reading->text();
  }
}

TEST(Energy, ADarkTextureLeavesRoomForALobe) {
  const std::string obj = "mtllib m.mtl\n" + kBox + "vt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";
  const std::string mtl = "newmtl a\nKd 1 1 1\nKs 0.5 0.5 0.5\nmap_Kd t.ppm\n";
  for (const bool bright : {false, true}) {
    const auto reading =
        read_meshes({{"m.obj", obj},
                     {"m.mtl", mtl},
                     {"t.ppm", "P6\n1 1\n255\n" + std::string(3, bright ? '\xff' : '\x20')}});
    ASSERT_TRUE(reading->out) << reading->text();
    EXPECT_EQ(count(reading->log, Code("W1402")), bright ? 1u : 0u) << reading->text();
    EXPECT_NEAR(reading->material(0).specular.x, bright ? 1.0 / 3 : 0.5, 1e-15);
  }
}

// ---- lost properties

TEST(Lost, PropertiesHaveAPlaceInEveryFormat) {
  Sample velvet = triangle();
  velvet.json["extensionsUsed"] = {"KHR_materials_sheen"};
  velvet.json["materials"] = {
      {{"name", "plain"}}, {{"extensions", {{"KHR_materials_sheen", nlohmann::json::object()}}}}};
  velvet.json["meshes"][0]["primitives"][0]["material"] = 1;
  const std::string obj = "mtllib m.mtl\n" + kBox + "usemtl a\nf 1 2 3\n";
  const std::string shape =
      "Shape {\nappearance Appearance { material Material { diffuseColor 2 0 0 } }\ngeometry Box "
      "{} }";
  struct Case {
    std::vector<MemoryFile> files;
    std::string place;  // file and line; of glTF a pointer
    std::string more;   // of the message
  };
  const std::vector<Case> cases = {
      {{{"m.obj", obj}, {"m.mtl", "newmtl a\nKd 1 1 1\naniso 0.5\nsharpness 2\nPcr 1\n"}},
       "m.mtl:3:1: ",
       "anisotropy, clearcoat (line 5)"},
      {{{"m.obj", obj}, {"m.mtl", "newmtl a\nKd 1 1 1\nKs 1 nan 1\n"}}, "m.mtl:3:6: ", "outside"},
      {{{"m.wrl", "#VRML V2.0 utf8\n" + shape}}, "m.wrl:3:34: ", "outside"},
      {{{"m.wrl", "#VRML V1.0 ascii\nSeparator {\nMaterial { diffuseColor 2 0 0 } Cube {} }"}},
       "m.wrl:3:1: ",
       "outside"},
      {{{"m.urdf",
         "<robot name=\"r\"><link name=\"a\"><visual><geometry><sphere radius=\"1\"/></geometry>"
         "\n<material name=\"m\"><color rgba=\"1 2 1 1\"/></material></visual></link></robot>"}},
       "m.urdf:2:",
       "outside"},
      {{{"m.xml",
         "<mujoco><asset>\n<texture type=\"skybox\" builtin=\"gradient\"/></asset><worldbody>"
         "<geom size=\"1\"/></worldbody></mujoco>"}},
       "m.xml:2:2: ",
       "procedural textures"},
      {{{"m.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
         "float z\nproperty float heat\nelement face 1\nproperty list uchar int vertex_indices\n"
         "end_header\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n"}},
       "m.ply:7:16: ",
       "'heat'"},
      {{{"m.glb", velvet.glb()}}, "m.glb: ", "sheen (at /materials/1)"},
  };
  for (const Case& each : cases) {
    const auto reading = read_meshes(each.files);
    ASSERT_TRUE(reading->out) << reading->text();
    EXPECT_EQ(count(reading->log, Code("W6008")), 1u) << reading->text();
    EXPECT_THAT("\n" + reading->text(), HasSubstr("\n" + each.place)) << each.place;
    EXPECT_THAT(reading->text(), HasSubstr(each.more)) << reading->text();
  }
}

// ---- normal maps

TEST(NormalMaps, ColourImagesAreReported) {
  const std::string obj = "mtllib m.mtl\n" + kBox + "vt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";
  const auto said = [&](const std::string& texel) {
    const auto reading = read_meshes({{"m.obj", obj},
                                      {"m.mtl", "newmtl a\nKd 1 1 1\nnorm t.ppm\n"},
                                      {"t.ppm", "P6\n1 1\n255\n" + texel}});
    return count(reading->log, Code("W3003"));
  };
  EXPECT_EQ(said("\x80\x80\xff"), 0u);
  EXPECT_EQ(said("\xb4\x80\xf3"), 0u);  // tilted by 24 degrees
  EXPECT_EQ(said(std::string("\xff\0\0", 3)), 1u);
  EXPECT_EQ(said("\x60\x60\x60"), 1u);
  EXPECT_EQ(said("\xd0\xb0\x50"), 1u);
}

}  // namespace
}  // namespace panwright::importers::appearance_test
