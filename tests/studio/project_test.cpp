// Models that are read again as their files change.
#include "studio/project.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "tests/support/process.h"

namespace panwright::studio {
namespace {

using support::TemporaryFolder;

std::string model(const std::string& size) {
  return "<pangu_model ver=\"1\"><include file=\"part.pxn\"/><box size=\"" + size +
         "\"/></pangu_model>\n";
}
const std::string kPart = "<pangu_model ver=\"1\"><sphere radius=\"1\"/></pangu_model>\n";

bool comes(const Project& project, const std::function<bool(const Project::State&)>& what) {
  for (int i = 0; i < 3000; ++i) {
    if (what(project.state())) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

TEST(Project, FollowsItsFilesAndWhatTheyInclude) {
  const TemporaryFolder folder;
  folder.write("part.pxn", kPart);
  const std::string top = folder.write("model.pxn", model("1"));
  Project project({top}, {});
  ASSERT_TRUE(comes(project, [](const auto& s) { return s.world && !s.reading; }));
  const auto first = project.state();
  EXPECT_FALSE(first.failed);
  EXPECT_EQ(first.watched.size(), 2u);

  folder.write("part.pxn", "<pangu_model ver=\"1\"><sphere radius=\"2\"/></pangu_model>\n");
  ASSERT_TRUE(comes(project, [&](const auto& s) { return s.world != first.world; }));
  EXPECT_NE((*project.state().world)[0].model()->build_id(), (*first.world)[0].model()->build_id());
}

// Where one of several cannot be read from the beginning, the others are shown; once it can, all.
TEST(Project, ShowsThoseThatCanBeRead) {
  const TemporaryFolder folder;
  folder.write("part.pxn", kPart);
  const std::string good = folder.write("good.pxn", model("1"));
  const std::string bad = folder.write("bad.pxn", "<pangu_model ver=\"1\"><boxx/></pangu_model>\n");
  Project project({bad, good}, {});
  ASSERT_TRUE(comes(project, [](const auto& s) { return s.world && !s.reading; }));
  const auto state = project.state();
  EXPECT_TRUE(state.failed);
  EXPECT_TRUE(state.partial);
  ASSERT_EQ(state.world->size(), 1u);
  EXPECT_EQ((*state.world)[0].name(), "good");
  EXPECT_EQ(state.watched.size(), 3u);
  EXPECT_FALSE(state.messages.empty());
  folder.write("bad.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>\n");
  ASSERT_TRUE(comes(project, [](const auto& s) { return s.world && s.world->size() == 2; }));
  EXPECT_FALSE(project.state().failed);
  EXPECT_FALSE(project.state().partial);
}

// A broken edit keeps what there was and says what is wrong, until it is mended.
TEST(Project, KeepsTheLastGoodOne) {
  const TemporaryFolder folder;
  folder.write("part.pxn", kPart);
  const std::string top = folder.write("model.pxn", model("1"));
  Project project({top}, {});
  ASSERT_TRUE(comes(project, [](const auto& s) { return s.world != nullptr; }));
  const auto good = project.state().world;

  folder.write("model.pxn", "<pangu_model ver=\"1\">\n<boxx/>\n</pangu_model>\n");
  ASSERT_TRUE(comes(project, [](const auto& s) { return s.failed; }));
  auto state = project.state();
  EXPECT_EQ(state.world, good);
  ASSERT_FALSE(state.messages.empty());
  EXPECT_EQ(state.messages[0].code, "E1101");
  EXPECT_EQ(state.messages[0].file, top);
  EXPECT_EQ(state.messages[0].line, 2u);

  std::filesystem::remove(top);
  ASSERT_TRUE(comes(project, [&](const auto& s) {
    return !s.messages.empty() && s.messages[0].code == "E0101";
  }));
  EXPECT_EQ(project.state().world, good);

  folder.write("model.pxn", "<pangu_model ver=\"1\"><inc");
  ASSERT_TRUE(comes(project, [&](const auto& s) {
    return !s.messages.empty() && s.messages[0].code != "E0101";
  }));
  folder.write("model.pxn", model("3"));
  ASSERT_TRUE(comes(project, [&](const auto& s) { return !s.failed && s.world != good; }));

  // an include that includes what includes it
  folder.write("part.pxn", "<pangu_model ver=\"1\"><include file=\"model.pxn\"/></pangu_model>\n");
  ASSERT_TRUE(comes(project, [&](const auto& s) { return s.failed; }));
  EXPECT_TRUE(project.state().world);
  folder.write("part.pxn", kPart);
  ASSERT_TRUE(comes(project, [&](const auto& s) { return !s.failed; }));
}

TEST(Project, NothingToBeginWith) {
  const TemporaryFolder folder;
  Project project({folder / "later.pxn"}, {});
  ASSERT_TRUE(comes(project, [](const auto& s) { return s.failed && s.readings == 1; }));
  EXPECT_FALSE(project.state().world);
  folder.write("later.pxn", kPart);
  ASSERT_TRUE(comes(project, [](const auto& s) { return s.world != nullptr; }));
}

// It ends while it reads, and many errors are bounded.
TEST(Project, ManyErrorsAndEarlyEnds) {
  const TemporaryFolder folder;
  std::string text = "<pangu_model ver=\"1\">\n";
  for (int i = 0; i < 5000; ++i) text += "<boxx/>\n";
  const std::string top = folder.write("bad.pxn", text + "</pangu_model>\n");
  {
    Project project({top}, {});
    ASSERT_TRUE(comes(project, [](const auto& s) { return s.failed; }));
    EXPECT_LE(project.state().messages.size(), 401u);
    EXPECT_GE(project.state().messages.size(), 200u);
  }
  for (int i = 0; i < 20; ++i) Project project({top}, {});
}

}  // namespace
}  // namespace panwright::studio
