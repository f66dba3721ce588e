// Files named by files: every format finds, guesses and refuses the same names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/importers/meshes/mesh_files.h"

namespace panwright::importers::named_files_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kStl =
    "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
    "endfacet\nendsolid s\n";
constexpr const char* kVrml =
    "#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 "
    "1 0 ] } coordIndex [ 0 1 2 ] } }\n";
const std::string kTriangle(
    "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0", 36);
const std::string kPicture("P6\n1 1\n255\n\x10\x20\x30", 14);
const std::string kFaces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";

// A model that names one file, and what that file holds.
struct Naming {
  const char* model;
  std::string before, after;  // of the name
  const char* extension;
  std::string contents;
  bool part;
  Code deviation;
};

std::vector<Naming> namings() {
  const auto gltf = [](const std::string& view, const std::string& rest) {
    return "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{"
           "\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}" +
           view +
           "}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":"
           "\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]}],\"bufferViews\":[{\"buffer\":0,"
           "\"byteLength\":36}]" +
           rest;
  };
  return {
      {"m.obj", "mtllib ", "\n" + kFaces + "usemtl a\nf 1/1 2/2 3/3\n", ".mtl",
       "newmtl a\nKd 1 0 0\n", false, Code("W6502")},
      {"m.obj", kFaces + "usemtl a\nf 1/1 2/2 3/3\nmtllib ", "\n", ".mtl", "newmtl a\nKd 1 0 0\n",
       false, Code("W6502")},
      {"m.ply", "ply\nformat ascii 1.0\ncomment TextureFile ",
       "\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float "
       "s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
       "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n",
       ".ppm", kPicture, false, Code("W6502")},
      {"m.gltf", gltf("", ",\"buffers\":[{\"byteLength\":36,\"uri\":\""), "\"}]}", ".bin",
       kTriangle, true, Code("W6215")},
      {"m.wrl", "#VRML V2.0 utf8\nShape { appearance Appearance { texture ImageTexture { url \"",
       "\" } } geometry Box { } }\n", ".ppm", kPicture, false, Code("W6118")},
      {"m.wrl", "#VRML V2.0 utf8\nInline { url \"", "\" }\nShape { geometry Box { } }\n", ".wrl",
       kVrml, true, Code("W6118")},
      {"m.urdf", "<robot name='r'><link name='l'><visual><geometry><mesh filename='",
       "'/></geometry></visual></link></robot>", ".stl", kStl, true, Code("W6221")},
      {"m.urdf",
       "<robot name='r'><link name='l'><visual><geometry><box size='1 1 1'/></geometry><material "
       "name='m'><texture filename='",
       "'/></material></visual></link></robot>", ".ppm", kPicture, false, Code("W6221")},
      {"m.xml", "<mujoco><asset><mesh name='a' file='",
       "'/></asset><worldbody><geom type='mesh' mesh='a'/></worldbody></mujoco>", ".stl", kStl,
       true, Code("W6221")},
      {"m.xml", "<mujoco><worldbody><geom size='1'/></worldbody><include file='", "'/></mujoco>",
       ".xml", "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>", true, Code("W6221")},
  };
}

class Folder {
 public:
  // tests of one program run side by side
  Folder()
      : path_(fs::temp_directory_path() / ("panwright_named_files_" + std::to_string(::getpid()))) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  fs::path write(const std::string& name, const std::string& bytes) const {
    fs::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

enum class Found { as_written, with_warning, no };

// Writes the file at `at` and a model that calls it `name`, and reads the model.
void expect_found(const Naming& naming, const std::string& at, const std::string& name,
                  Found wanted, const std::string& root = {}) {
  const Folder folder;
  folder.write("project/" + at + naming.extension, naming.contents);
  std::string written;
  const bool escaped =
      std::string_view(naming.model) == "m.gltf" || std::string_view(naming.model) == "m.wrl";
  for (const char c : name) written += escaped && c == '\\' ? "\\\\" : std::string(1, c);
  const fs::path model = folder.write(std::string("project/robots/") + naming.model,
                                      naming.before + written + naming.extension + naming.after);
  Options options;
  if (!root.empty()) options.root = folder.path() / root;
  const fs::path before = fs::current_path();
  for (const bool relative : {false, true}) {
    if (relative) fs::current_path(folder.path());
    DiagnosticLog log(1000);
    const auto read =
        import_file(relative ? model.lexically_relative(folder.path()) : model, options, log);
    fs::current_path(before);
    const std::string what =
        std::string(naming.model) + " " + name + " at " + at + "\n" + to_text(log);
    const bool found = read && read->scene.inputs.size() == 2;
    EXPECT_EQ(found, wanted != Found::no) << what;
    EXPECT_EQ(log.contains(naming.deviation), wanted == Found::with_warning) << what;
    if (found) EXPECT_FALSE(log.has_errors()) << what;
    if (wanted == Found::no && naming.part) EXPECT_TRUE(log.has_errors()) << what;
    if (wanted == Found::no && !naming.part)
      EXPECT_TRUE(log.contains(Code("W6004")) || log.contains(Code("W6005"))) << what;
  }
}

TEST(NamedFiles, AreFoundBesideTheModel) {
  for (const Naming& naming : namings()) {
    expect_found(naming, "robots/x", "x", Found::as_written);
    expect_found(naming, "robots/sub/x", "sub/x", Found::as_written);
    expect_found(naming, "robots/sub/x", ".\\sub\\x", Found::as_written);
    expect_found(naming, "robots/x", "y", Found::no);
  }
}

TEST(NamedFiles, AreFoundInAnotherLetterCase) {
  for (const Naming& naming : namings()) {
    expect_found(naming, "robots/Sub/X y", "sub/x Y", Found::with_warning);
    expect_found(naming, "robots/x", "X", Found::with_warning);
  }
}

TEST(NamedFiles, OfOtherMachinesAreLookedForBesideTheModel) {
  for (const Naming& naming : namings()) {
    expect_found(naming, "robots/x", "C:\\work\\sat\\x", Found::with_warning);
    expect_found(naming, "robots/x", "/home/someone/sat/x", Found::with_warning);
    expect_found(naming, "robots/x", "/home/someone/sat/y", Found::no);
  }
}

TEST(NamedFiles, AreTakenFromTheWholeRoot) {
  for (const Naming& naming : namings()) {
    expect_found(naming, "parts/x", "../parts/x", Found::no);
    expect_found(naming, "parts/x", "../parts/x", Found::as_written, "project");
    expect_found(naming, "../parts/x", "../../parts/x", Found::no, "project");
  }
}

TEST(NamedFiles, OfPackagesAreLookedForAboveTheModel) {
  for (const Naming& naming : namings()) {
    if (std::string(naming.model) != "m.urdf") continue;
    expect_found(naming, "meshes/x", "package://sat/meshes/x", Found::as_written, "project");
    expect_found(naming, "sat/meshes/x", "package://sat/meshes/x", Found::as_written, "project");
    expect_found(naming, "meshes/X", "model://sat/meshes/x", Found::with_warning, "project");
    expect_found(naming, "meshes/x", "package://sat/meshes/x", Found::no);
  }
}

TEST(NamedFiles, BehindLinksThatLeadOutAreRefused) {
  const Naming naming = namings().front();
  const Folder folder;
  folder.write("secret.mtl", naming.contents);
  const fs::path model = folder.write("project/m.obj", naming.before + "link.mtl" + naming.after);
  fs::create_symlink(folder.path() / "secret.mtl", folder.path() / "project/link.mtl");
  DiagnosticLog log(100);
  const auto read = import_file(model, {}, log);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->scene.inputs.size(), 1u);
  EXPECT_TRUE(log.contains(Code("W6005"))) << to_text(log);
}

TEST(NamedFiles, ALinkThatTheUserNamesIsFollowed) {
  const Naming naming = namings().front();
  const Folder folder;
  folder.write("here/x.mtl", naming.contents);
  const fs::path model = folder.write("there/m", naming.before + "x.mtl" + naming.after);
  fs::create_symlink(model, folder.path() / "here/link.obj");
  DiagnosticLog log(100);
  const auto read = import_file(folder.path() / "here/link.obj", {}, log);
  ASSERT_TRUE(read) << to_text(log);
  EXPECT_EQ(read->scene.inputs.size(), 2u) << to_text(log);
}

// Names are percent-encoded in glTF and VRML only; a program that does otherwise is said.
TEST(NamedFiles, MayBePercentEncoded) {
  for (const Naming& naming : namings()) {
    const std::string model = naming.model;
    const bool encoded = model == "m.gltf" || model == "m.wrl";
    expect_found(naming, "robots/a b", "a%20b", encoded ? Found::as_written : Found::with_warning);
    expect_found(naming, "robots/a%20b", "a%20b",
                 encoded ? Found::with_warning : Found::as_written);
  }
}

}  // namespace
}  // namespace panwright::importers::named_files_test
