#include "image/arrays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

#include "base/file.h"
#include "image/image.h"
#include "image/internal/zip.h"
#include "tests/image/image_folder.h"

namespace panwright::image::arrays_test {
namespace {

using testing::ElementsAre;

class ArrayFiles : public testing_support::ImageFolder {};

Image with_depth() {
  Image image;
  image.width = 5;
  image.height = 3;
  image.radiance.resize(45);
  image.coverage.resize(15);
  for (std::size_t i = 0; i < 15; ++i)
    image.depth.push_back(i == 4 ? std::numeric_limits<float>::infinity()
                                 : 1 + static_cast<float>(i) / 3);
  image.range = image.depth;
  image.normal.resize(45);
  image.target_id.resize(15);
  image.node_id.resize(15);
  image.material_id.resize(15);
  return image;
}

TEST_F(ArrayFiles, DepthOfImages) {
  const Image image = with_depth();
  for (const char* name : {"a.exr", "a.npz", "b.npz"}) {
    DiagnosticLog log;
    FileOptions options;
    options.compress = *name == 'b';
    ASSERT_TRUE(write_image(path(name), image, 0, log, nullptr, options));
    const auto depth = read_depth(path(name), 5, 3, log);
    ASSERT_TRUE(depth) << name;
    EXPECT_EQ(*depth, image.depth) << name;
    EXPECT_FALSE(read_depth(path(name), 3, 5, log)) << name;
    EXPECT_TRUE(log.contains(Code("E0102"))) << name;
    options.layers &= ~(1u << static_cast<unsigned>(FileLayer::depth));
    ASSERT_TRUE(write_image(path(name), image, 0, log, nullptr, options));
    const auto none = read_depth(path(name), 5, 3, log);
    ASSERT_TRUE(none) << name;
    EXPECT_TRUE(none->empty()) << name;
  }
}

TEST_F(ArrayFiles, DamagedImagesHaveNoDepth) {
  const Image image = with_depth();
  for (const char* name : {"a.exr", "a.npz"}) {
    DiagnosticLog log;
    ASSERT_TRUE(write_image(path(name), image, 0, log));
    const std::string good = bytes(path(name));
    for (std::size_t size = 0; size < good.size(); size += 13) {
      std::ofstream(path(name), std::ios::binary) << good.substr(0, size);
      DiagnosticLog damaged;
      const auto depth = read_depth(path(name), 5, 3, damaged);
      EXPECT_TRUE(depth || damaged.has_errors()) << name << " " << size;
      if (depth && !depth->empty()) EXPECT_EQ(depth->size(), 15u);
    }
  }
}

// Records of zip64, which archives of over 4 GB have.
TEST_F(ArrayFiles, LargeArchives) {
  DiagnosticLog log;
  auto file = AtomicFile::create(path("z.zip"), log);
  ASSERT_TRUE(file);
  ZipWriter writer(*file, 0);
  ASSERT_TRUE(writer.add("a", as_bytes("plain"), {}, log));
  ASSERT_TRUE(writer.add("b", as_bytes("deflated"), {}, log, true));
  ASSERT_TRUE(writer.finish(log) && file->commit(log));
  const std::string archive = bytes(path("z.zip"));
  const ZipReader reader(as_bytes(archive));
  ASSERT_TRUE(reader.good());
  ASSERT_EQ(reader.entries().size(), 2u);
  std::vector<std::string> found;
  for (const ZipReader::Entry& entry : reader.entries()) {
    const auto content = reader.content(entry);
    ASSERT_TRUE(content) << entry.name;
    found.emplace_back(reinterpret_cast<const char*>(content->data()), content->size());
  }
  EXPECT_THAT(found, ElementsAre("plain", "deflated"));
}

// As numpy writes archives, with records of zip64 for small ones too; arrays in Fortran's order are
// refused.
TEST_F(ArrayFiles, ArchivesOfAnotherProgram) {
  const std::string script =
      "import sys, zipfile\n"
      "with zipfile.ZipFile(sys.argv[1], 'w', zipfile.ZIP_DEFLATED) as z:\n"
      "  for name, fortran in ((\"a\", False), (\"f\", True)):\n"
      "    head = (\"{'descr': '<f4', 'fortran_order': %s, 'shape': (2, 3), }\" % fortran)\n"
      "    head = head.ljust(117) + chr(10)\n"
      "    with z.open(name + '.npy', 'w', force_zip64=True) as f:\n"
      "      f.write(b'\\x93NUMPY\\x01\\x00' + bytes([118, 0]) + head.encode() + "
      "bytes(range(24)))\n";
  std::ofstream(path("s.py")) << script;
  const std::string command =
      std::string(PANWRIGHT_PYTHON) + " " + path("s.py").string() + " " + path("n.npz").string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  DiagnosticLog log;
  const std::string_view wanted[] = {"a"};
  const auto arrays = read_arrays(path("n.npz"), wanted, 1000, log);
  ASSERT_TRUE(arrays);
  ASSERT_EQ(arrays->size(), 1u);
  EXPECT_EQ((*arrays)[0].type, "<f4");
  EXPECT_THAT((*arrays)[0].shape, ElementsAre(2, 3));
  ASSERT_EQ((*arrays)[0].data.size(), 24u);
  EXPECT_EQ((*arrays)[0].data[23], std::byte{23});
  EXPECT_FALSE(read_arrays(path("n.npz"), {}, 1000, log));
  EXPECT_TRUE(log.contains(Code("E0102")));
  DiagnosticLog small;
  EXPECT_FALSE(read_arrays(path("n.npz"), wanted, 100, small));
  EXPECT_TRUE(small.contains(Code("E0104")));
}

}  // namespace
}  // namespace panwright::image::arrays_test
