#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/process.h"
#include "workspace/views.h"

namespace panwright::workspace {
namespace {

Result<std::vector<ViewText>> read(const std::string& text, DiagnosticLog& log,
                                   const ViewText& defaults = {}) {
  const support::TemporaryFolder folder;
  return read_views(folder.write("v.json", text), defaults, log);
}

TEST(ReadViews, TakesTextNumbersAndLists) {
  DiagnosticLog log;
  const auto views =
      read(R"([{"camera": [0, -5, 1.5], "fov": 20, "sun": "1 0 0", "output": "a.png"},
                              {"look_at": "0 0 1", "output": "b.npy"}])",
           log);
  ASSERT_TRUE(views) << to_text(log);
  ASSERT_EQ(views->size(), 2u);
  EXPECT_EQ((*views)[0].camera, "0 -5 1.5");
  EXPECT_EQ((*views)[0].fov, "20");
  EXPECT_EQ((*views)[1].look_at, "0 0 1");
}

TEST(ReadViews, DefaultsFillInWithoutContradicting) {
  ViewText defaults;
  defaults.fov = "20";
  defaults.look_at = "1 1 1";
  defaults.size = "10x10";
  defaults.camera = "5 5 5";
  DiagnosticLog log;
  const auto views = read(R"([{"ortho": 3, "quat": [1, 0, 0, 0], "output": "a.png"},
                              {"camera_frame": "f", "output": "b.png"}])",
                          log, defaults);
  ASSERT_TRUE(views);
  EXPECT_FALSE((*views)[0].fov);
  EXPECT_FALSE((*views)[0].look_at);
  EXPECT_EQ((*views)[0].size, "10x10");
  EXPECT_EQ((*views)[0].camera, "5 5 5");
  EXPECT_FALSE((*views)[1].camera);
  EXPECT_FALSE((*views)[1].look_at);
  EXPECT_EQ((*views)[1].fov, "20");
}

std::vector<std::string> poses_of(const ViewText& view) {
  std::vector<std::string> out;
  for (const PoseText& pose : view.poses) out.push_back(pose.target + "=" + pose.value);
  return out;
}

TEST(ReadViews, PosesAreTextsListsOrObjectsOfTargets) {
  ViewText defaults;
  defaults.poses = {{"a", "9"}, {"b", "8"}};
  DiagnosticLog log;
  const auto views = read(R"([{"pose": [1, 2, 3, 1, 0, 0, 0], "output": "a.png"},
                              {"pose": "1 2 3", "output": "b.png"},
                              {"pose": {"b": "0 0 1", "c": [2]}, "output": "c.png"},
                              {"output": "d.png"}])",
                          log, defaults);
  ASSERT_TRUE(views) << to_text(log);
  using testing::ElementsAre;
  // the view's own come last, so that they are what counts
  EXPECT_THAT(poses_of((*views)[0]), ElementsAre("a=9", "b=8", "=1 2 3 1 0 0 0"));
  EXPECT_THAT(poses_of((*views)[1]), ElementsAre("a=9", "b=8", "=1 2 3"));
  EXPECT_THAT(poses_of((*views)[2]), ElementsAre("a=9", "b=8", "b=0 0 1", "c=2"));
  EXPECT_THAT(poses_of((*views)[3]), ElementsAre("a=9", "b=8"));
}

TEST(ReadViews, SaysWhatIsWrong) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "invalid JSON"},
      {"[{\"output\": \"a.png\"},\n {]", "line 2"},
      {"{}", "expected a list of"},
      {"[]", "expected a list of"},
      {"[3]", "view 0 is not an object"},
      {"[{\"fov\": 3}]", "view 0 has no output"},
      {"[{\"fof\": 3, \"output\": \"a\"}]", "unknown option"},
      {"[{\"fov\": {}, \"output\": \"a\"}]", "expected text, a number or a list"},
      {R"([{"output": "a"}, {"fov": 3, "fov": 4, "output": "b"}])", "view 1 gives 'fov' twice"},
      {R"([{"pose": {"client": "1", "b": "2", "client": "3"}, "output": "a"}])",
       "view 0 gives 'client' twice"},
      {R"([{"output": "a"}, {"output": "b"}, {"output": "c/../a"}])",
       "views 0 and 2 have the same output, 'c/../a'"},
      {"[{\"pose\": 1e, \"output\": \"a\"}]", "invalid JSON"},
      {"[{\"pose\": [], \"output\": \"a\"}]", "expected text, a number or a list"},
      {"[{\"pose\": {\"client\": {}}, \"output\": \"a\"}]", "the pose of 'client'"},
      {"[{\"poses\": {}, \"output\": \"a\"}]", "unknown option"},
      {"[{\"sun\": [1, \"x\"], \"output\": \"a\"}]", "expected text, a number or a list"},
  };
  for (const auto& [text, words] : cases) {
    DiagnosticLog log;
    EXPECT_FALSE(read(text, log)) << text;
    ASSERT_FALSE(log.entries().empty());
    EXPECT_EQ(log.entries()[0].code, Code::E0203);
    EXPECT_THAT(log.entries()[0].message, testing::HasSubstr(words));
  }
  DiagnosticLog log;
  (void)read("[{\"fof\": 3, \"output\": \"a\"}]", log);
  EXPECT_EQ(log.entries()[0].hint, "did you mean 'fov'?");
  DiagnosticLog missing;
  EXPECT_FALSE(read_views("/nonexistent.json", {}, missing));
  EXPECT_TRUE(missing.contains(Code::E0101));
}

}  // namespace
}  // namespace panwright::workspace
