// Includes: where files are looked for, what they may not do, what is shared.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/pxn/reading.h"
#include "tests/support/process.h"

namespace panwright::pxn::include_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string model(const std::string& nodes) {
  return "<pangu_model ver=\"0\">" + nodes + "</pangu_model>";
}
std::string include(const std::string& file) {
  return "<include type=\"pxn\" file=\"" + file + "\"/>";
}
const std::string kSphere = "<sphere rings=\"4\" quads=\"4\"/>";
const std::string kMesh =
    "<mesh><positions><vec3>0 0 0</vec3><vec3>1 0 0</vec3><vec3>0 1 0</vec3></positions>"
    "<tristrips><tristrip>0 1 2</tristrip></tristrips></mesh>";

std::size_t rings(const Reading& r, std::size_t instance) {
  const auto shape = static_cast<std::size_t>(r.scene->instances.at(instance).shape);
  return std::get<geometry::Sphere>(r.scene->shapes[shape]).counts->rings;
}

TEST(Include, TheTopFilesFolderComesFirst) {
  const support::TemporaryFolder folder;
  fs::create_directories(folder.path() / "parts");
  folder.write("parts/a.pxn", model(include("b.pxn") + include("c.pxn") + include("parts/c.pxn")));
  folder.write("b.pxn", model("<sphere rings=\"5\" quads=\"4\"/>"));
  folder.write("parts/b.pxn", model("<sphere rings=\"6\" quads=\"4\"/>"));
  folder.write("parts/c.pxn", model("<sphere rings=\"7\" quads=\"4\"/>"));
  const Reading r = read_path(folder.write("top.pxn", model(include("parts/a.pxn"))));
  EXPECT_EQ(r.summary(), "");
  ASSERT_EQ(r.scene->instances.size(), 3u);
  EXPECT_EQ(rings(r, 0), 5u) << "the top file's folder, not the including file's";
  EXPECT_EQ(rings(r, 1), 7u) << "the including file's, where the top file's has none";
  EXPECT_EQ(rings(r, 2), 7u);
  std::vector<std::string> inputs;
  for (const scene::Input& input : r.scene->inputs) {
    inputs.push_back(input.path);
    const std::string bytes = support::contents(folder.path() / input.path);
    EXPECT_EQ(input.bytes, bytes.size());
    EXPECT_EQ(input.hash, hash128(std::as_bytes(std::span(bytes))));
  }
  EXPECT_EQ(inputs, (std::vector<std::string>{"top.pxn", "parts/a.pxn", "b.pxn", "parts/c.pxn"}));
}

TEST(Include, AFileIsReadOnceAndItsShapesAreShared) {
  const Reading r = read_files(
      {{"top.pxn", model(include("p.pxn") + "<group>" + include("./p.pxn") + "</group>")},
       {"p.pxn", model(kMesh + kSphere)}});
  EXPECT_EQ(r.summary(), "");
  ASSERT_TRUE(r.scene);
  EXPECT_EQ(r.scene->shapes.size(), 2u);
  EXPECT_EQ(r.scene->instances.size(), 4u);
  EXPECT_EQ(r.scene->inputs.size(), 2u);
  EXPECT_EQ(r.scene->nodes[1].name, "p");
  std::set<std::string> names;
  for (const scene::Node& node : r.scene->nodes)
    EXPECT_TRUE(names.insert(node.name).second) << node.name;
  EXPECT_EQ(r.scene->instances[2].source.file, "p.pxn");
}

TEST(Include, ProblemsOfASharedFileAreSaidOnce) {
  const Reading r = read_files(
      {{"top.pxn", model(include("p.pxn") + include("p.pxn"))}, {"p.pxn", model("<spere/>")}});
  EXPECT_EQ(r.codes(), std::multiset<std::string>{"E1101"});
}

TEST(Include, EachUseHasItsOwnStack) {
  // the label is fine in the file; it is the second use that is wrong
  const std::string frame =
      "<frame_s label=\"a\"><origin><vec3>0 0 0</vec3></origin><forward><vec3>0 0 "
      "1</vec3></forward>"
      "<up><vec3>0 -1 0</vec3></up><right><vec3>1 0 0</vec3></right></frame_s>";
  const Reading r =
      read_files({{"top.pxn", model("\n" + include("p.pxn") + "\n" + include("p.pxn"))},
                  {"p.pxn", model(frame)}});
  EXPECT_EQ(r.codes(), std::multiset<std::string>{"E1210"});
  EXPECT_THAT(to_text(r.log), HasSubstr("included from top.pxn:3:1"));
  EXPECT_EQ(r.scene->frames.size(), 1u);
}

TEST(Include, NothingOutsideTheRoot) {
  const support::TemporaryFolder folder;
  fs::create_directories(folder.path() / "project/parts");
  folder.write("secret.pxn", model(kSphere));
  folder.write("project/ok.pxn", model(kSphere));
  folder.write("project/parts/up.pxn", model(include("../ok.pxn")));
  fs::create_symlink(folder.path() / "secret.pxn", folder.path() / "project/link.pxn");
  fs::create_directory_symlink(folder.path(), folder.path() / "project/out");
  fs::create_symlink("ok.pxn", folder.path() / "project/fine.pxn");
  const auto codes = [&](const std::string& file, const Options& options = {}) {
    return read_path(folder.write("project/top.pxn", model(include(file))), options).summary();
  };
  for (const std::string& file :
       {std::string("../secret.pxn"), std::string("parts/../../secret.pxn"),
        std::string("link.pxn"), std::string("out/secret.pxn"),
        std::string("parts/../out/secret.pxn"), folder / "secret.pxn", std::string("/etc/hostname"),
        std::string("../no-such-file")}) {
    EXPECT_THAT(codes(file), HasSubstr("E1303")) << file;
    EXPECT_THAT(codes(file), testing::Not(HasSubstr("E1301"))) << file;
  }
  for (const std::string& file :
       {std::string("ok.pxn"), std::string("fine.pxn"), std::string("parts/up.pxn"),
        std::string("./parts/../ok.pxn"), folder / "project/ok.pxn"}) {
    EXPECT_EQ(codes(file), "") << file;
  }
  Options wider;
  wider.root = folder.path();
  EXPECT_EQ(codes("../secret.pxn", wider), "");
  EXPECT_EQ(codes("out/secret.pxn", wider), "");
}

TEST(Include, MissingFilesHaveNearNames) {
  const support::TemporaryFolder folder;
  folder.write("antenna.pxn", model(kSphere));
  EXPECT_THAT(read_path(folder.write("t.pxn", model(include("antena.pxn")))).summary(),
              HasSubstr("(did you mean 'antenna.pxn'?)"));
  EXPECT_THAT(read_path(folder.write("t.pxn", model(include("parts\\a.pxn")))).summary(),
              HasSubstr("folders are separated by '/'"));
  EXPECT_THAT(read_path(folder.write("t.pxn", model(include(std::string(100000, 'x'))))).summary(),
              HasSubstr("E1301"));
  fs::create_directories(folder.path() / "dir.pxn");
  EXPECT_THAT(read_path(folder.write("t.pxn", model(include("dir.pxn")))).summary(),
              HasSubstr("E1301"));
  EXPECT_THAT(read_path(folder.write("t.pxn", model(include("")))).summary(), HasSubstr("E1103"));
}

TEST(Include, DepthOfFilesAndOfElements) {
  std::vector<MemoryFile> chain;
  for (int i = 0; i <= 70; ++i)
    chain.push_back({std::to_string(i) + ".pxn",
                     model(i < 64 ? include(std::to_string(i + 1) + ".pxn") : kSphere)});
  EXPECT_EQ(read_files(chain).summary(), "") << "64 files inside files";
  chain[64].bytes = model(include("65.pxn"));
  EXPECT_THAT(read_files(chain).summary(), HasSubstr("E1304"));

  // 100 groups, then a file with 200
  const auto groups = [](int n, const std::string& inside) {
    std::string out = inside;
    for (int i = 0; i < n; ++i) out = "<group>" + out + "</group>";
    return out;
  };
  const auto deep = [&](int outer, int inner) {
    return read_files({{"t.pxn", model(groups(outer, include("p.pxn")))},
                       {"p.pxn", model(groups(inner, kSphere))}})
        .codes();
  };
  // root, groups, include; root, groups, sphere
  EXPECT_EQ(deep(100, 152), std::multiset<std::string>{});
  EXPECT_EQ(deep(100, 153), std::multiset<std::string>{"E1006"});
  EXPECT_EQ(deep(101, 152), std::multiset<std::string>{"E1006"});
}

TEST(Include, LimitsOnBytesAndUses) {
  Options options;
  options.limits.bytes = 200;
  const std::string part = model(kSphere + std::string(100, ' '));
  EXPECT_THAT(read_files({{"t.pxn", model(include("p.pxn"))}, {"p.pxn", part}}, options).summary(),
              HasSubstr("E0104"));
  const support::TemporaryFolder folder;
  folder.write("p.pxn", part);
  const Reading r = read_path(folder.write("t.pxn", model(include("p.pxn"))), options);
  EXPECT_EQ(r.codes(), std::multiset<std::string>{"E0104"});
  EXPECT_TRUE(r.scene) << "the rest of the model is still there";

  Options few;
  few.limits.includes = 2;
  const Reading three = read_files(
      {{"t.pxn", model(include("p.pxn") + include("p.pxn") + include("p.pxn") + include("p.pxn"))},
       {"p.pxn", model(kSphere)}},
      few);
  EXPECT_EQ(three.codes(), std::multiset<std::string>{"E1304"});
  EXPECT_EQ(three.scene->instances.size(), 2u);
}

}  // namespace
}  // namespace panwright::pxn::include_test
