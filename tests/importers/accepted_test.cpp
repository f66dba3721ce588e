// Whatever an importer returns, the reader of pan files accepts: files of all formats with numbers
// at the edges, compiled and read again.
#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "compiler/compile.h"
#include "importers/clean.h"
#include "importers/import.h"
#include "pan/model.h"

namespace panwright::importers::accepted_test {
namespace {

// Texts whose '@' become numbers.
struct Family {
  const char* name;
  std::vector<MemoryFile> files;
};

const std::string kGltf =
    R"({"asset":{"version":"2.0"},"extensionsUsed":["AGI_articulations","KHR_materials_specular",)"
    R"("KHR_materials_ior","KHR_materials_emissive_strength"],"scenes":[{"nodes":[0]}],"nodes":[)"
    R"({"name":"a","children":[1,2],"translation":[@,@,@],"extensions":{"AGI_articulations":)"
    R"({"articulationName":"turn"}}},{"mesh":0,"scale":[@,@,@],"extensions":{"AGI_articulations":)"
    R"({"articulationName":"slide"}}},{"mesh":0,"rotation":[@,@,@,@],"extensions":)"
    R"({"AGI_articulations":{"articulationName":"all"}}}],"materials":[{"pbrMetallicRoughness":)"
    R"({"baseColorFactor":[@,@,@,@],"metallicFactor":@,"roughnessFactor":@},"emissiveFactor":)"
    R"([@,@,@],"alphaMode":"BLEND","extensions":{"KHR_materials_ior":{"ior":@},)"
    R"("KHR_materials_specular":{"specularFactor":@,"specularColorFactor":[@,@,@]},)"
    R"("KHR_materials_emissive_strength":{"emissiveStrength":@}}}],"meshes":[{"primitives":)"
    R"([{"attributes":{"POSITION":0},"material":0}]}],"accessors":[{"bufferView":0,)"
    R"("componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"bufferViews":)"
    R"([{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":)"
    R"("data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],)"
    R"("extensions":{"AGI_articulations":{"articulations":[{"name":"turn","pointingVector":)"
    R"([@,@,@],"stages":[{"name":"s","type":"xRotate","minimumValue":@,"maximumValue":@,)"
    R"("initialValue":@}]},{"name":"slide","stages":[{"name":"t","type":"yTranslate",)"
    R"("minimumValue":@,"maximumValue":@,"initialValue":@},{"name":"u","type":"uniformScale",)"
    R"("minimumValue":@,"maximumValue":@,"initialValue":@}]},{"name":"all","stages":[)"
    R"({"name":"zRotate","type":"zRotate","minimumValue":@,"maximumValue":@,"initialValue":@},)"
    R"({"name":"yRotate","type":"yRotate","initialValue":@},)"
    R"({"name":"xRotate","type":"xRotate","minimumValue":@,"maximumValue":@}]}]}}})";

const std::string kVrml97 = R"(#VRML V2.0 utf8
PROTO Joint [ exposedField SFVec3f center 0 0 0 exposedField MFNode children []
  exposedField MFFloat llimit [] exposedField MFFloat ulimit [] exposedField SFString name ""
  exposedField SFRotation rotation 0 0 1 0 exposedField SFVec3f translation 0 0 0
  exposedField SFString jointType "" exposedField SFVec3f jointAxis 0 0 1 ]
{ Transform { center IS center children IS children rotation IS rotation translation IS translation } }
PROTO Segment [ exposedField MFNode children [] field SFFloat mass 0 field SFVec3f centerOfMass 0 0 0
  field MFFloat momentsOfInertia [ 0 0 0 0 0 0 0 0 0 ] ] { Group { children IS children } }
DEF A Joint { jointType "rotate" jointAxis @ @ @ llimit [ @ ] ulimit [ @ ] translation @ @ @ children [
 DEF B Joint { jointType "slide" jointAxis @ @ @ llimit [ @ ] ulimit [ @ ] center @ @ @ children
  Segment { mass @ centerOfMass @ @ @ momentsOfInertia [ @ @ @ @ @ @ @ @ @ ] children Transform { translation @ @ @ rotation @ @ @ @ scale @ @ @ scaleOrientation @ @ @ @ center @ @ @ children [
   Shape { appearance Appearance { material Material { diffuseColor @ @ @ specularColor @ @ @ shininess @ transparency @ emissiveColor @ @ @ } } geometry Sphere { radius @ } }
   Shape { geometry Cone { bottomRadius @ height @ } } Shape { geometry Cylinder { radius @ height @ } }
   Shape { geometry Box { size @ @ @ } }
   Shape { geometry ElevationGrid { xDimension 2 zDimension 2 xSpacing @ zSpacing @ height [ @ @ @ @ ] } }
   Shape { geometry Extrusion { crossSection [ 0 0, @ 0, @ @ ] spine [ 0 0 0, 0 @ 0, @ @ @ ] } }
   Shape { geometry IndexedFaceSet { coord Coordinate { point [ @ @ @, @ @ @, @ @ @, 0 1 0 ] } coordIndex [ 0 1 2 3 -1 ] creaseAngle @ } } ] } } } ] }
)";

const std::string kVrml1 = R"(#VRML V1.0 ascii
Separator { Translation { translation @ @ @ } Rotation { rotation @ @ @ @ } Scale { scaleFactor @ @ @ }
 MatrixTransform { matrix 1 0 0 0  0 1 0 0  0 0 @ 0  @ @ @ 1 }
 Material { diffuseColor @ @ @ specularColor @ @ @ shininess @ transparency @ }
 Sphere { radius @ } Cone { bottomRadius @ height @ } Cube { width @ height @ depth @ }
 Coordinate3 { point [ @ @ @, @ @ @, @ @ @, 0 1 0 ] } IndexedFaceSet { coordIndex [ 0, 1, 2, 3, -1 ] } }
)";

const std::string kUrdf = R"(<robot name="r"><material name="m"><color rgba="@ @ @ @"/></material>
<link name="a"><visual><origin xyz="@ @ @" rpy="@ @ @"/><geometry><box size="@ @ @"/></geometry><material name="m"/></visual>
<visual><geometry><mesh filename="m.obj" scale="@ @ @"/></geometry></visual></link>
<link name="b"><inertial><mass value="@"/><inertia ixx="@" ixy="@" ixz="@" iyy="@" iyz="@" izz="@"/></inertial>
<visual><geometry><sphere radius="@"/></geometry></visual></link>
<link name="c"><visual><geometry><cylinder radius="@" length="@"/></geometry></visual></link>
<link name="d"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><origin xyz="@ @ @"/><axis xyz="@ @ @"/><limit lower="@" upper="@" effort="1" velocity="1"/></joint>
<joint name="k" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="@ @ @"/><limit lower="@" upper="@" effort="1" velocity="1"/><mimic joint="j" multiplier="@" offset="@"/></joint>
<joint name="l" type="continuous"><parent link="c"/><child link="d"/><mimic joint="k" multiplier="@" offset="@"/></joint></robot>)";

const std::string kMjcf =
    R"(<mujoco><asset><material name="m" rgba="@ @ @ @"/><mesh name="o" file="m.obj" scale="@ @ @"/>
<mesh name="p" vertex="@ @ @ 1 0 0 0 @ 0 0 0 @" face="0 2 1 0 1 3 0 3 2 1 2 3"/></asset>
<worldbody><geom type="mesh" mesh="p"/><geom type="sphere" size="@"/><geom type="plane" size="@ @ 1"/><geom type="box" size="1 1 1"/><body name="a" pos="@ @ @" euler="@ @ @"><joint name="j" type="hinge" axis="@ @ @" pos="@ @ @" range="@ @" ref="@"/>
<geom type="capsule" size="@ @"/><geom type="capsule" fromto="@ @ @ @ @ @" size="@"/><geom type="ellipsoid" size="@ @ @" material="m"/>
<body name="b"><joint name="k" type="slide" axis="@ @ @" range="@ @" ref="@"/><geom type="mesh" mesh="o" pos="@ @ @" quat="@ @ @ @"/><geom type="cylinder" size="@ @"/>
</body></body></worldbody><equality><joint joint1="k" joint2="j" polycoef="@ @ 0 0 0"/></equality></mujoco>)";

const std::string kObj =
    "mtllib m.mtl\nusemtl m\nv @ @ @\nv @ @ @\nv @ @ @\nv 0 1 0\nvt @ @\nvn @ @ @\n"
    "f 1/1/1 2/1/1 3/1/1\nf 1 2 4\nf 2 3 4\n";
const std::string kMtl = "newmtl m\nKd @ @ @\nKs @ @ @\nKe @ @ @\nNs @\nNi @\nd @\nPr @\nPm @\n";
const std::string kStl =
    "solid s\nfacet normal @ @ @\nouter loop\nvertex @ @ @\nvertex @ @ @\nvertex @ @ @\nendloop\n"
    "endfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
    "endfacet\nendsolid s\n";
const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "property float nx\nproperty float ny\nproperty float nz\nelement face 2\n"
    "property list uchar int vertex_indices\nend_header\n@ @ @ @ @ @\n@ @ @ @ @ @\n@ @ @ 0 0 1\n"
    "0 1 0 0 0 1\n3 0 1 2\n3 0 1 3\n";

const MemoryFile kPart{"m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"};
const std::vector<Family> kFamilies = {
    {"glTF", {{"m.gltf", kGltf}}},       {"VRML 97", {{"m.wrl", kVrml97}}},
    {"VRML 1.0", {{"m.wrl", kVrml1}}},   {"URDF", {{"m.urdf", kUrdf}, kPart}},
    {"MJCF", {{"m.xml", kMjcf}, kPart}}, {"OBJ", {{"n.obj", kObj}, {"m.mtl", kMtl}}},
    {"STL", {{"m.stl", kStl}}},          {"PLY", {{"m.ply", kPly}}},
};

constexpr const char* kEdges[] = {"0",     "-0",   "1e-300", "1e-40",  "1e-20", "-1e-9", "1e9",
                                  "-1e12", "1e15", "1e29",   "1e38",   "-1e39", "1e300", "-1e308",
                                  "360",   "-7",   "1e16",   "3.5e38", "1e-29", "1e30",  "2e30"};

std::string filled(const std::string& text, std::mt19937_64& random, double edges) {
  std::string out;
  const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (const char c : text)
    if (c != '@')
      out += c;
    else if (share() < edges)
      out += kEdges[random() % std::size(kEdges)];
    else
      out += std::to_string(0.05 + 0.9 * share());
  return out;
}

// The problem that the reader of pan files has with what was imported, compiled; empty: none.
std::string problem_of(const std::vector<MemoryFile>& files, std::optional<double> unit,
                       bool& accepted) {
  DiagnosticLog log(1000);
  auto imported = import_memory(files, {}, log);
  if (!imported) return log.has_errors() ? "" : "nothing returned, nothing reported";
  place(*imported, unit, std::nullopt, false, log);
  if (const std::string problem = scene::check(imported->scene); !problem.empty()) return problem;
  compiler::Options options;
  options.max_error = 0.05;
  options.max_triangles = 20000;
  DiagnosticLog compile_log(1000);
  const auto bytes = compiler::compiled(imported->scene, options, compile_log);
  if (!bytes) return compile_log.has_errors() ? "" : "not compiled, nothing reported";
  DiagnosticLog read_log(1000);
  auto model = pan::Model::from_bytes(*bytes, "m.pan", read_log);
  accepted = model && model->check(read_log);
  return accepted ? "" : to_text(read_log);
}

TEST(Accepted, WhatImportersReturnTheReaderTakes) {
  constexpr int kFiles = 250;
  const std::optional<double> units[] = {std::nullopt, 1.0, 1e-6, 1e3};
  for (const Family& family : kFamilies) {
    int accepted = 0;
    for (int seed = 0; seed < kFiles; ++seed) {
      std::mt19937_64 random(static_cast<std::uint64_t>(seed));
      // from one edge in a file to one in five numbers
      const double edges = seed % 2 == 0 ? 0.02 : 0.2;
      std::vector<MemoryFile> files = family.files;
      for (MemoryFile& file : files) file.bytes = filled(file.bytes, random, edges);
      bool taken = false;
      const std::string problem = problem_of(files, units[random() % 4], taken);
      EXPECT_EQ(problem, "") << family.name << ", seed " << seed << '\n' << files[0].bytes;
      accepted += taken;
    }
    EXPECT_GT(accepted, kFiles / 10) << family.name;
  }
}

}  // namespace
}  // namespace panwright::importers::accepted_test
