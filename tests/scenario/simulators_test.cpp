// Outputs of 42 and Basilisk.
#include "scenario/simulators.h"

#include <gtest/gtest.h>

#include "tests/scenario/support.h"

namespace panwright::scenario::simulators_test {
namespace {

using support::at;
using support::codes;
using support::first_line;

std::string problem_42(const std::string& time, std::optional<std::string> position,
                       std::optional<std::string> rotation) {
  DiagnosticLog log;
  FortyTwoTexts texts{memory_text("time.42", time), {}, {}, "a"};
  if (position) texts.position = memory_text("PosR.42", *position);
  if (rotation) texts.rotation = memory_text("qbn.42", *rotation);
  const auto source = read_42(texts, log);
  EXPECT_EQ(source.ok(), !log.has_errors());
  return codes(log) + ":" + std::to_string(first_line(log));
}

TEST(FortyTwo, PositionsAndRotations) {
  DiagnosticLog log;
  const auto source = read_42({memory_text("time.42", " 0.000000e+00\n 2.000000e+00\n"),
                               memory_text("PosR.42", "1.0 2.0 3.0\n 3.0 2.0 3.0 \n"),
                               memory_text("qbn.42", "0 0 0 1\n0 0 1 0\n"), "a"},
                              log);
  ASSERT_TRUE(source) << to_text(log);
  EXPECT_EQ(codes(log), "");
  const Frame frame = at(**source, 1);
  EXPECT_EQ(frame.targets.at(0).placement.position, Vec3(2, 2, 3));
  EXPECT_LT(length(*frame.targets.at(0).placement.rotation * Vec3(1, 0, 0) - Vec3(0, 1, 0)), 1e-15);
}

TEST(FortyTwo, Problems) {
  EXPECT_EQ(problem_42("0\n1\n", "1 2 3\n4 5 6\n", {}), ":0");
  EXPECT_EQ(problem_42("0\n1\n", "7e6 2 3\n4 5 6\n", {}), "W8012:1");
  EXPECT_EQ(problem_42("0\n1\n", {}, {}), "E8001:1");
  EXPECT_EQ(problem_42("", "", {}), "E8001:1");
  EXPECT_EQ(problem_42("0\n0\n", "1 2 3\n4 5 6\n", {}), "E8004:2");
  EXPECT_EQ(problem_42("0\n1\n", "1 2 3\n", {}), "E8001:1");
  EXPECT_EQ(problem_42("0\n1\n", "1 2 3\n4 5\n", {}), "E8001:2");
  EXPECT_EQ(problem_42("0\n1\n", {}, "0 0 0 1\n0 0 0 nan\n"), "E8001:2");
  EXPECT_EQ(problem_42("0\n1\n", {}, "0 0 0 1\n0 0 0 0\n"), "E8005:2");
  EXPECT_EQ(problem_42("0\n1\n", {}, "0 0 0 1\n0 0 0.2 1\n"), "W8006:2");
}

std::string problem_basilisk(const std::string& text) {
  DiagnosticLog log;
  const auto source = read_basilisk(memory_text("b.csv", text), "a", log);
  EXPECT_EQ(source.ok(), !log.has_errors());
  return codes(log) + ":" + std::to_string(first_line(log));
}

// From one set of parameters to the other within a step: no turn backwards.
TEST(Basilisk, SwitchesToTheShadowSet) {
  DiagnosticLog log;
  // 170 and 190 degrees about z: tan(42.5°), and −1/tan(47.5°)
  const auto source = read_basilisk(
      memory_text("b.csv",
                  "# time[ns] r_BN_N_x r_BN_N_y r_BN_N_z sigma_BN_0 sigma_BN_1 sigma_BN_2\n"
                  "0 7e6 0 0 0 0 0.9163311740174235\n"
                  "1000000000 7e6 100 0 0 0 -0.9163311740174235\n"),
      "a", log);
  ASSERT_TRUE(source) << to_text(log);
  EXPECT_EQ(codes(log), "");
  const Frame frame = at(**source, 0.5);
  EXPECT_EQ(frame.targets.at(0).placement.position, Vec3(7e6, 50, 0));
  EXPECT_LT(length(*frame.targets.at(0).placement.rotation * Vec3(1, 0, 0) - Vec3(-1, 0, 0)),
            1e-15);
}

TEST(Basilisk, Problems) {
  const std::string r = "r_BN_N[0],r_BN_N[1],r_BN_N[2]";
  EXPECT_EQ(problem_basilisk("time[s]," + r + "\n0,1,2,3\n"), ":0");
  EXPECT_EQ(problem_basilisk("time," + r + "\n0,1,2,3\n"), "N8010:1");
  EXPECT_EQ(problem_basilisk("time[s]," + r + ",omega\n0,1,2,3,4\n"), "W8002:1");
  EXPECT_EQ(problem_basilisk(r + "\n1,2,3\n"), "E8001:1");
  EXPECT_EQ(problem_basilisk("time[s]\n1\n"), "E8001:1");
  EXPECT_EQ(problem_basilisk("time[s],r_BN_N[0]\n1,2\n"), "E8001:1");
  EXPECT_EQ(problem_basilisk("time[s],time[ns]," + r + "\n0,0,1,2,3\n"), "E8008:1");
  EXPECT_EQ(problem_basilisk("time[s]," + r + "\n"), "E8001:1");
  EXPECT_EQ(problem_basilisk(""), "E8001:1");
  EXPECT_EQ(problem_basilisk("time[s]," + r + "\n0,1,2\n"), "E8001:2");
  EXPECT_EQ(problem_basilisk("time[s]," + r + "\n0,1,2,nan\n"), "E8001:2");
  EXPECT_EQ(problem_basilisk("time[s]," + r + "\n1,1,2,3\n0,1,2,3\n"), "E8004:3");
}

}  // namespace
}  // namespace panwright::scenario::simulators_test
