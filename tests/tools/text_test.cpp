// fmt, upgrade and expand as a user runs them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace panwright::text_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using support::contents;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

const std::string kServicer = PANWRIGHT_SOURCE_DIR "/examples/servicer";

TEST(Fmt, InPlaceOnceAndForAll) {
  const TemporaryFolder folder;
  const std::string untidy = folder.write(
      "a.pxn", "<pangu_model ver='1'><!-- ball --><sphere   radius='1'/></pangu_model>");
  fs::permissions(untidy, fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  const std::string before = contents(untidy);

  const Outcome check = panwright({"fmt", "--check", untidy});
  EXPECT_EQ(check.code, 1);
  EXPECT_EQ(check.out, untidy + "\n");
  EXPECT_EQ(check.err, "");
  EXPECT_EQ(contents(untidy), before);

  EXPECT_EQ(panwright({"fmt", untidy}).code, 0);
  const std::string after = contents(untidy);
  EXPECT_EQ(after,
            "<pangu_model ver=\"1\"> <!-- ball -->\n  <sphere radius=\"1\"/>\n</pangu_model>\n");
  EXPECT_EQ(fs::status(untidy).permissions(),
            fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  const Outcome again = panwright({"fmt", "--check", untidy, "--json"});
  EXPECT_EQ(again.code, 0);
  EXPECT_EQ(json::parse(again.out)["files"][0]["changed"], false);
  // nothing else is left behind
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);

  EXPECT_EQ(panwright({"fmt", untidy, "-o", "-"}).out, after);
  EXPECT_EQ(panwright({"fmt", untidy, "-o", folder / "b.pxn"}).code, 0);
  EXPECT_EQ(contents(folder / "b.pxn"), after);
  EXPECT_EQ(panwright({"fmt", untidy, untidy, "-o", "-"}).code, 2);
}

TEST(Fmt, WhatIsNoXmlStaysAsItIs) {
  const TemporaryFolder folder;
  const std::string good = folder.write("good.pxn", "<a  b='1'/>");
  const std::string bad = folder.write("bad.pxn", "<a  b='1'>");
  const Outcome outcome = panwright({"fmt", bad, good});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("E1001"));
  EXPECT_EQ(contents(bad), "<a  b='1'>");
  // the others are formatted
  EXPECT_EQ(contents(good), "<a b=\"1\"/>\n");
  EXPECT_EQ(panwright({"fmt", folder / "none.pxn"}).code, 3);
  EXPECT_EQ(panwright({"fmt", good, "--max-input", "5"}).code, 3);
}

TEST(Upgrade, InPlaceOnceAndForAll) {
  const TemporaryFolder folder;
  const std::string model = folder / "m.pxn";
  fs::copy_file(PANWRIGHT_SOURCE_DIR "/examples/paper/figure8.pxn", model);
  ASSERT_EQ(panwright({"compile", model, "-o", folder / "before.pan"}).code, 0);
  EXPECT_EQ(panwright({"upgrade", model}).code, 0);
  EXPECT_THAT(contents(model), HasSubstr("ver=\"1\""));
  ASSERT_EQ(panwright({"compile", model, "-o", folder / "after.pan"}).code, 0);
  EXPECT_EQ(panwright({"diff", folder / "before.pan", folder / "after.pan"}).code, 0);
  const Outcome again = panwright({"upgrade", model});
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.err, HasSubstr("is of level 1 already"));
  // what it writes is in canonical form
  EXPECT_EQ(panwright({"fmt", "--check", model}).code, 0);
  EXPECT_EQ(panwright({"upgrade", folder / "m.pan"}).code, 2);
}

TEST(Expand, TheServicerInOneFile) {
  const TemporaryFolder folder;
  const std::string out = folder / "one.pxn";
  // note: wrinkled blankets are written as the meshes that they are, which is another model
  const Outcome outcome =
      panwright({"expand", kServicer + "/servicer.pxn", "-D", "foil=0", "-o", out});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::string text = contents(out);
  for (const char* gone : {"<part", "<use", "<repeat", "<param", "{"})
    EXPECT_THAT(text, Not(HasSubstr(gone)));
  ASSERT_EQ(
      panwright({"compile", kServicer + "/servicer.pxn", "-D", "foil=0", "-o", folder / "a.pan"})
          .code,
      0);
  ASSERT_EQ(panwright({"compile", out, "-o", folder / "b.pan"}).code, 0);
  const Outcome diff = panwright({"diff", folder / "a.pan", folder / "b.pan"});
  EXPECT_EQ(diff.code, 0) << diff.out;
  // expanded, it stays as it is, images and all
  EXPECT_EQ(panwright({"expand", out, "-o", folder / "two.pxn"}).code, 0);
  EXPECT_TRUE(contents(folder / "two.pxn") == text);
  EXPECT_EQ(panwright({"expand", out, "-o", out}).code, 2);
  EXPECT_EQ(panwright({"expand", out}).code, 2);
}

TEST(Expand, HiddenPartsStayAway) {
  const TemporaryFolder folder;
  const std::string relay = PANWRIGHT_SOURCE_DIR "/examples/cad/relay.pxn";
  ASSERT_EQ(panwright({"expand", relay, "-o", folder / "x.pxn", "-q"}).code, 0);
  const auto triangles = [](const std::string& model) {
    return json::parse(panwright({"info", model, "--json"}).out)["triangles"].get<int>();
  };
  EXPECT_EQ(triangles(folder / "x.pxn"), triangles(relay));
}

}  // namespace
}  // namespace panwright::text_test
