// Which names lead to which files, and what is kept out.

#include "importers/files.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

#include "importers/import.h"
#include "importers/internal/gzip.h"

namespace panwright::importers::files_test {
namespace {

namespace fs = std::filesystem;

TEST(Resolved, names_in_the_folder_of_the_including_file) {
  EXPECT_EQ(resolved("a/model.wrl", "part.wrl", false), "a/part.wrl");
  EXPECT_EQ(resolved("a/model.wrl", "../b/part.wrl", false), "b/part.wrl");
  EXPECT_EQ(resolved("a/model.wrl", "b\\part.wrl", false), "a/b/part.wrl");
  EXPECT_EQ(resolved("model.gltf", "a%20b.bin", true), "a b.bin");
  EXPECT_EQ(resolved("model.wrl", "a%20b.bin", false), "a%20b.bin");
  EXPECT_EQ(resolved("model.wrl", "file:part.wrl", false), "part.wrl");
}

TEST(Resolved, what_is_no_relative_path_is_nothing) {
  for (const char* uri :
       {"/etc/passwd", "http://a/b.wrl", "C:\\part.wrl", "urn:x:y", "", "file:///etc/passwd"})
    EXPECT_FALSE(resolved("model.wrl", uri, false)) << uri;
  for (const char* uri : {"%2Fetc/passwd", "a%00b"})
    EXPECT_FALSE(resolved("model.gltf", uri, true)) << uri;
}

TEST(Files, links_out_of_the_folder_are_not_followed) {
  const fs::path folder = fs::temp_directory_path() / "panwright_files_test";
  fs::remove_all(folder);
  fs::create_directories(folder / "in");
  std::ofstream(folder / "secret") << "secret";
  std::ofstream(folder / "in/part") << "part";
  fs::create_symlink(folder / "secret", folder / "in/link");
  const auto files = files_in_folder(folder / "in", 6, DiagnosticLog());
  SharedText bytes;
  EXPECT_EQ(files->read("link", bytes), Files::Outcome::outside);
  for (const char* path : {"../secret", "../in/part", "..", "../none", "/etc/passwd"})
    EXPECT_EQ(files->read(path, bytes), Files::Outcome::outside) << path;
  EXPECT_EQ(files->read("none", bytes), Files::Outcome::missing);
  EXPECT_EQ(files->read("part", bytes), Files::Outcome::found);
  EXPECT_EQ(*bytes, "part");
  EXPECT_EQ(files->read("part", bytes), Files::Outcome::too_large);
  fs::remove_all(folder);
}

TEST(Files, large_ones_are_mapped_and_stay_readable_when_forgotten) {
  const fs::path folder = fs::temp_directory_path() / "panwright_mapped_files_test";
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::string text;
  while (text.size() < (3u << 20)) text += std::to_string(text.size()) + "\n";
  // one that fills its last page, which has no room for the NUL behind it, and one that does not
  for (const std::size_t size : {std::size_t{2} << 20, (std::size_t{2} << 20) + 77}) {
    const std::string part = text.substr(0, size);
    std::ofstream(folder / "large", std::ios::binary) << part;
    const auto files = files_in_folder(folder, 1 << 30, DiagnosticLog());
    SharedText bytes;
    ASSERT_EQ(files->read("large", bytes), Files::Outcome::found);
    EXPECT_TRUE(*bytes == part);
    bytes.forget(0, bytes->size());
    const SharedText copy = std::exchange(bytes, nullptr);
    EXPECT_TRUE(bytes == nullptr);
    EXPECT_TRUE(*copy == part);
    EXPECT_EQ(copy->data()[copy->size()], '\0');
    copy.forget(4097, 4098);
    copy.forget(part.size(), part.size());
    // places are those of the text
    SourceMap sources;
    const FileId id = sources.add({"large", copy, Encoding::utf8, {}});
    const auto lines = std::count(part.begin(), part.end(), '\n');
    const Position last = sources.position(id, static_cast<std::uint32_t>(part.rfind('\n') + 1));
    EXPECT_EQ(last.line, static_cast<std::uint32_t>(lines) + 1);
    EXPECT_EQ(last.column, 1u);
  }
  fs::remove_all(folder);
}

TEST(Files, one_file_whose_name_differs_in_case_is_found) {
  const fs::path folder = fs::temp_directory_path() / "panwright_case_files_test";
  fs::remove_all(folder);
  fs::create_directories(folder / "Maps");
  for (const char* name : {"Maps/Gold.PNG", "two", "Two"}) std::ofstream(folder / name) << "x";
  const auto files = files_in_folder(folder, 100, DiagnosticLog());
  EXPECT_EQ(files->same_but_for_case("maps/gold.png"), "Maps/Gold.PNG");
  EXPECT_EQ(files->same_but_for_case("Maps/gold.png"), "Maps/Gold.PNG");
  EXPECT_EQ(files->same_but_for_case("maps/silver.png"), std::nullopt);
  EXPECT_EQ(files->same_but_for_case("TWO"), std::nullopt);
  fs::remove_all(folder);
}

std::string packed(const std::string& text) {
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY);
  std::string out(compressBound(text.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(out.size() - stream.avail_out);
  deflateEnd(&stream);
  return out;
}

TEST(Gzip, every_truncation_and_every_flipped_byte_is_noticed) {
  std::string text;
  for (int i = 0; i < 4000; ++i) text += std::to_string(i * i) + " ";
  const std::string whole = packed(text);
  const auto read = [](std::string bytes, std::uint64_t most = 1 << 20) {
    return internal::unpacked(std::make_shared<const std::string>(std::move(bytes)), most);
  };
  ASSERT_EQ(*read(whole).bytes, text);
  EXPECT_EQ(*read(whole + packed("more")).bytes, text + "more");
  EXPECT_TRUE(read(whole + std::string(512, '\0')).problem.empty());
  EXPECT_EQ(*read(packed(whole)).bytes, text);
  EXPECT_EQ(*read(packed(packed(whole))).bytes, text);
  EXPECT_FALSE(read(whole, text.size() - 1).bytes);
  for (std::size_t n = 2; n < whole.size(); n += 7)
    EXPECT_FALSE(read(whole.substr(0, n)).problem.empty()) << n;
  for (std::size_t i = 10; i < whole.size(); i += 11) {
    std::string flipped = whole;
    flipped[i] = static_cast<char>(flipped[i] ^ 0x10);
    EXPECT_FALSE(read(flipped).problem.empty()) << i;
  }
}

TEST(Gzip, models_are_read_whatever_they_are_called) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const char* name :
       {"m.obj", "m.obj.gz", "m.obj.gzip", "M.OBJ.GZ", "m.obj.Z", "m.obj.part.bin"}) {
    const std::vector<MemoryFile> files = {{name, packed(obj)}};
    DiagnosticLog log;
    const auto read = import_memory(files, {}, log);
    ASSERT_TRUE(read) << name << to_text(log);
    EXPECT_EQ(read->format, Format::obj) << name;
  }
}

TEST(Gzip, models_without_a_telling_name_are_known_by_their_bytes) {
  const float corners[] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::string stl(80, ' ');
  stl += std::string("\x01\0\0\0", 4);
  stl += std::string(reinterpret_cast<const char*>(corners), sizeof corners) + std::string(2, '\0');
  const std::pair<std::string, Format> texts[] = {
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", Format::obj},
      {"# made by hand\n\n#\no part\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", Format::obj},
      {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
       "endloop\nendfacet\nendsolid\n",
       Format::stl},
      {stl, Format::stl},
      {"#VRML V2.0 utf8\nShape { geometry Box { } }\n", Format::vrml97}};
  for (const auto& [text, format] : texts)
    for (const char* name : {"m", "m.dat"}) {
      const std::vector<MemoryFile> files = {{name, packed(text)}};
      DiagnosticLog log;
      const auto read = import_memory(files, {}, log);
      ASSERT_TRUE(read) << name << to_text(log);
      EXPECT_EQ(read->format, format) << text;
    }
}

TEST(Import, other_formats_are_refused_by_name) {
  const struct {
    const char* path;
    std::string bytes;
    const char* name;
  } cases[] = {{"model.wrl", "#X3D V3.0 utf8\n", "X3D"},
               {"model.wrl", "<?xml version='1.0'?>", "XML"},
               {"a.x3d", "<?xml version='1.0'?>\n<!DOCTYPE X3D><X3D></X3D>", "X3D"},
               {"a.dae", "<?xml version='1.0'?>\n<COLLADA></COLLADA>", "COLLADA"},
               {"a.dae", "<COLLADA></COLLADA>", "COLLADA"},
               {"a.fbx", std::string("Kaydara FBX Binary  \0\x1a", 22), "FBX"},
               {"a.fbx", "; FBX 7.3.0 project file\n", "FBX"},
               {"a.3ds", std::string("MM\x20\0\0\0\x02\0", 8), "3DS"},
               {"a.usdc", "PXR-USDC", "USD"},
               {"a.igs", "        S      1\n", "IGES"},
               {"a.3mf", "PK\x03\x04", "3MF"},
               {"a.blend", "BLENDER-v300", "Blender"},
               {"a.usdz", "PK\x03\x04", "USD is not"},
               {"a.zip", "PK\x03\x04", "ZIP"},
               {"a.dxf", "  0\nSECTION\n", "DXF"},
               {"a.DWG", "AC1032", "DWG"},
               {"part.SLDPRT", "\xd0\xcf\x11\xe0", "SolidWorks"},
               {"a.x_t", "**ABCDEFGHIJKLMNOPQRSTUVWXYZ****", "Parasolid"}};
  for (const auto& each : cases) {
    DiagnosticLog log;
    const MemoryFile files[] = {{each.path, each.bytes}};
    EXPECT_FALSE(import_memory(files, {}, log));
    EXPECT_TRUE(log.contains(Code("E6001"))) << each.path;
    EXPECT_NE(to_text(log).find(each.name), std::string::npos) << to_text(log);
    // FreeCAD has no reader of it
    if (std::string(each.path) == "a.x_t")
      EXPECT_EQ(to_text(log).find("FreeCAD"), std::string::npos) << to_text(log);
  }
}

}  // namespace
}  // namespace panwright::importers::files_test
