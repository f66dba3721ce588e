// Saved layout of the window.
#include "studio/layout.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/process.h"

namespace panwright::studio {
namespace {

TEST(Layout, RoundTrip) {
  const support::TemporaryFolder folder;
  const std::filesystem::path file =
      std::filesystem::path(folder / "state") / "panwright" / "window.json";
  std::string problem = "old";
  EXPECT_EQ(read_layout(file, problem), Layout{});
  EXPECT_EQ(problem, "");
  Layout layout;
  layout.width = 1920;
  layout.height = 1000;
  layout.panel = 300.5;
  layout.panel_shown = false;
  layout.text = 1.3;
  layout.tab = "Parts";
  layout.layer = "false colours";
  layout.mark_white = layout.labels = true;
  ASSERT_TRUE(write_layout(file, layout));
  EXPECT_EQ(read_layout(file, problem), layout);
  EXPECT_EQ(problem, "");
}

TEST(Layout, InvalidMembersAreDefaults) {
  const support::TemporaryFolder folder;
  std::string problem;
  const Layout layout =
      read_layout(folder.write("w.json", R"({"width": 100000, "height": 600, "panel": "wide",
    "text": -1, "tab": "Moon", "layer": 3, "labels": true, "more": []})"),
                  problem);
  EXPECT_EQ(problem, "");
  Layout expected;
  expected.height = 600;
  expected.labels = true;
  EXPECT_EQ(layout, expected);
}

TEST(Layout, BrokenFileIsReported) {
  const support::TemporaryFolder folder;
  for (const std::string text : {"", "{\"width\": 800", "[1, 2]", "\xff\xfe"}) {
    std::string problem;
    EXPECT_EQ(read_layout(folder.write("w.json", text), problem), Layout{});
    EXPECT_NE(problem, "") << text;
  }
  std::string problem;
  EXPECT_EQ(read_layout(folder / "", problem), Layout{});
  EXPECT_NE(problem, "");
  EXPECT_FALSE(write_layout({}, Layout{}));
}

}  // namespace
}  // namespace panwright::studio
