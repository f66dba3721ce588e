// Reader of scripts.
#include "studio/script.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/support/process.h"

namespace panwright::studio {
namespace {

TEST(Script, AllKindsOfSteps) {
  const support::TemporaryFolder folder;
  DiagnosticLog log;
  const auto steps =
      read_script(folder.write("s.json", R"([{"click": "tab/Sun"}, {"type": ["sun/azimuth", 12.5]},
        {"drag": {"from": [0, 0.5], "to": [1, 0.25], "button": "middle"}}, {"scroll": -2},
        {"key": "F"}, {"wait": "read"}, {"wait": 3}, {"resize": [640, 480]},
        {"replace": {"file": "a.pxn", "text": "x", "with": "y"}}, {"screenshot": "s.png"},
        {"expect": ["failed", "false"]}])"),
                  log);
  ASSERT_TRUE(steps) << to_text(log);
  ASSERT_EQ(steps->size(), 11u);
  EXPECT_EQ((*steps)[1].value, "12.5");
  EXPECT_EQ((*steps)[2].button, 2);
  EXPECT_EQ((*steps)[2].to.y, 0.25);
  EXPECT_EQ((*steps)[6].amount, 3);
  EXPECT_EQ((*steps)[8].with, "y");
}

TEST(Script, Repeats) {
  const support::TemporaryFolder folder;
  DiagnosticLog log;
  const auto steps = read_script(
      folder.write("s.json", R"([{"wait": 1}, {"repeat": {"times": 3, "steps": [{"wait": 2},
        {"repeat": {"times": 2, "steps": [{"wait": 3}]}}]}}, {"drag": {"from": [0, 0], "to": [1, 0], "frames": 90}}])"),
      log);
  ASSERT_TRUE(steps) << to_text(log);
  std::string frames;
  for (const Step& each : *steps) frames += std::to_string(static_cast<int>(each.amount)) + " ";
  EXPECT_EQ(frames, "1 2 3 3 2 3 3 2 3 3 90 ");
}

TEST(Script, ErrorsNameTheStep) {
  const support::TemporaryFolder folder;
  for (const auto& [text, what] : {
           std::pair{"{", "not JSON"},
           std::pair{"{}", "a list of steps"},
           std::pair{"[1]", "step 1"},
           std::pair{R"([{"wait": 1}, {"clik": "a"}])", "step 2: unknown step 'clik'"},
           std::pair{R"([{"click": ["a"]}])", "must be a string"},
           std::pair{R"([{"type": ["a"]}])", "takes a name and a value"},
           std::pair{R"([{"drag": {"from": [0, 1]}}])", "'to' is missing"},
           std::pair{R"([{"drag": {"from": [0], "to": [0, 1]}}])", "two numbers"},
           std::pair{R"([{"drag": {"from": [0, 0], "to": [0, 1], "button": "up"}}])", "middle"},
           std::pair{R"([{"scroll": "up"}])", "the wheel"},
           std::pair{R"([{"scroll": 1e300}])", "the wheel"},
           std::pair{R"([{"wait": "long"}])", "exact, compared"},
           std::pair{R"([{"wait": ""}])", "exact, compared"},
           std::pair{R"([{"wait": 1e300}])", "0 to 100000 frames"},
           std::pair{R"([{"wait": -1}])", "0 to 100000 frames"},
           std::pair{R"([{"screenshot": ""}])", "without a name"},
           std::pair{R"([{"drag": {"from": [0, 0], "to": [0, 1e300]}}])", "at most 100000"},
           std::pair{R"([{"resize": [1, 1]}])", "320"},
           std::pair{R"([{"replace": {"file": "a", "text": "b"}}])", "'with' is missing"},
           std::pair{R"([{"repeat": 3}])", "'repeat' takes 'times'"},
           std::pair{R"([{"repeat": {"times": 0, "steps": [{"wait": 1}]}}])",
                     "'repeat' takes 'times'"},
           std::pair{R"([{"repeat": {"times": 3, "steps": [{"wait": 1}, {"clik": 1}]}}])",
                     "step 1, step 2: unknown step 'clik'"},
           std::pair{R"([{"repeat": {"times": 90000, "steps": [{"wait": 1}, {"wait": 1}]}}])",
                     "more than 100000"},
           std::pair{R"([{"drag": {"from": [0, 0], "to": [0, 1], "frames": 0}}])", "'frames'"},
       }) {
    DiagnosticLog log;
    EXPECT_FALSE(read_script(folder.write("s.json", text), log)) << text;
    ASSERT_EQ(log.errors(), 1u) << text;
    EXPECT_EQ(log.entries()[0].code, Code("E0203"));
    EXPECT_THAT(log.entries()[0].message, ::testing::HasSubstr(what)) << text;
  }
}

}  // namespace
}  // namespace panwright::studio
