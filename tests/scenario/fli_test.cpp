// Flight files, by the public facts of their commands.
#include "scenario/fli.h"

#include <gtest/gtest.h>

#include "tests/scenario/support.h"

namespace panwright::scenario::fli_test {
namespace {

using support::at;
using support::codes;
using support::first_line;
using support::turn_between;

SourcePtr read(const std::string& text, const std::string& expected = "",
               const FliOptions& options = {}) {
  DiagnosticLog log;
  auto source = read_fli(memory_text("t.fli", text), options, log);
  EXPECT_TRUE(source) << to_text(log);
  EXPECT_EQ(codes(log), expected) << to_text(log);
  return source ? *source : nullptr;
}

std::string problem(const std::string& text, bool strict = false) {
  DiagnosticLog log;
  FliOptions options;
  options.strict = strict;
  const auto source = read_fli(memory_text("t.fli", text), options, log);
  EXPECT_EQ(source.ok(), !log.has_errors());
  return codes(log) + ":" + std::to_string(first_line(log));
}

Frame frame_of(const Source& source, std::size_t index) {
  Frame frame;
  DiagnosticLog log;
  EXPECT_TRUE(source.frame(index, frame, log));
  return frame;
}

TEST(Fli, BoresightOfAngles) {
  // known views: from (0, −600, 600) with pitch −45 the origin is in the middle; pitch −90 is
  // quaternion (0, 1, 0, 0); positive yaw swings to −x; x of the camera is level
  const auto source = read(
      "start 0 -600 600 0 -45 0\nstart 0 0 9 0 -90 0\nstart 0 0 0 90 0 0\nstart 0 0 0 0 0 0\n");
  const auto bore = [&](std::size_t i) {
    return *frame_of(*source, i).camera.rotation * Vec3(0, 0, 1);
  };
  EXPECT_LT(length(bore(0) - normalize(Vec3(0, 600, -600))), 1e-15);
  EXPECT_LT(turn_between(*frame_of(*source, 1).camera.rotation, Quat(0, 1, 0, 0)), 1e-15);
  EXPECT_LT(length(bore(2) - Vec3(-1, 0, 0)), 1e-15);
  EXPECT_LT(length(*frame_of(*source, 3).camera.rotation * Vec3(1, 0, 0) - Vec3(1, 0, 0)), 1e-15);
  EXPECT_LT(length(*frame_of(*source, 3).camera.rotation * Vec3(0, 1, 0) - Vec3(0, 0, -1)), 1e-15);
}

// A line of six numbers changes the angles, also those of a quaternion.
TEST(Fli, ChangesFollowAnglesAndQuaternions) {
  const auto source = read(
      "start 1 2 3 10 20 30\n0.5 0 0 1 2 3\nstart 1.5 2 3 11 22 33\n"
      "quaternion 0 0 0 0.6 0 0.8 0\n0 0 0 0 0 0\n",
      "N8010");
  EXPECT_EQ(source->frames(), 5u);
  EXPECT_EQ(frame_of(*source, 1).camera.position, Vec3(1.5, 2, 3));
  EXPECT_LT(
      turn_between(*frame_of(*source, 1).camera.rotation, *frame_of(*source, 2).camera.rotation),
      1e-15);
  EXPECT_LT(
      turn_between(*frame_of(*source, 3).camera.rotation, *frame_of(*source, 4).camera.rotation),
      1e-14);
}

TEST(Fli, ObjectsAndSunHoldUntilTheyChange) {
  FliOptions options;
  options.targets["3"] = "client";
  const auto source = read(
      "quaternion 0 0 0 1 0 0 0\ndynamic_object 3 1 0 0 1 0 0 0\nsun_position 149597870700 90 0\n"
      "update\nupdate\ndynamic_object 3 3 0 0 1 0 0 0\nupdate\n",
      "N8010", options);
  EXPECT_EQ(source->frames(), 4u);
  EXPECT_TRUE(frame_of(*source, 0).targets.empty());
  EXPECT_FALSE(frame_of(*source, 0).sun_direction);
  EXPECT_EQ(frame_of(*source, 1).targets.at(0).name, "client");
  EXPECT_EQ(frame_of(*source, 2).targets.at(0).placement.position, Vec3(1, 0, 0));
  EXPECT_EQ(frame_of(*source, 3).targets.at(0).placement.position, Vec3(3, 0, 0));
  EXPECT_LT(length(*frame_of(*source, 2).sun_direction - Vec3(0, 1, 0)), 1e-15);
  EXPECT_EQ(frame_of(*source, 2).sun_distance, 1);
}

TEST(Fli, LineEndsAndComments) {
  const auto source = read(
      "# made by a tool\n\r\n\rstart 0 0 0 0 0 0# here\n\rpause 0.5\n\r"
      "\t start\t1 0  0 0 0 0\r\rupdate");
  EXPECT_EQ(source->frames(), 3u);
  EXPECT_EQ(source->info().ordered, 3u);
}

TEST(Fli, Times) {
  const std::string frames = "start 0 0 0 0 0 0\nstart 1 0 0 0 0 0\nstart 2 0 0 0 0 0\n";
  const auto by_comment = read("# Frame rate: 10\n" + frames, "N8010");
  EXPECT_EQ(by_comment->info().times, (std::vector<double>{0, 0.1, 0.2}));
  EXPECT_NEAR(at(*by_comment, 0.15).camera.position->x, 1.5, 1e-12);
  FliOptions options;
  options.frame_rate = 2;
  EXPECT_EQ(read("# Frame rate: 10\n" + frames, "", options)->info().times,
            (std::vector<double>{0, 0.5, 1}));
  const auto set = read("set_time 45150\nstart 0 0 0 0 0 0\nset_time 45160\nstart 1 0 0 0 0 0\n");
  EXPECT_EQ(set->info().times, (std::vector<double>{45150, 45160}));
  EXPECT_EQ(read("set_time 45150\n" + frames, "W8012")->info().ordered, 3u);
}

TEST(Fli, Problems) {
  EXPECT_EQ(problem(""), "E8001:1");
  EXPECT_EQ(problem("# start 0 0 0 0 0 0\n"), "E8001:1");
  EXPECT_EQ(problem("update\n"), "E8001:1");
  EXPECT_EQ(problem("0 0 0 0 0 0\n"), "E8001:1");
  EXPECT_EQ(problem("start 0 0 0 0 0 0\nstart 0 0 0 0 0\n"), "E8001:2");
  EXPECT_EQ(problem("start 0 0 0 0 0 0 0\n"), "E8001:1");
  EXPECT_EQ(problem("start 0 0 0 0 zero 0\n"), "E8001:1");
  EXPECT_EQ(problem("start 0 0 0 0 0 0\n1 2 3\n"), "E8001:2");
  EXPECT_EQ(problem("quaternion 0 0 0 0 0 0 0\n"), "E8005:1");
  EXPECT_EQ(problem("quaternion 0 0 0 nan 0 0 0\n"), "E8001:1");
  EXPECT_EQ(problem("quaternion 0 0 0 1.1 0 0 0\n"), "W8006:1");
  EXPECT_EQ(problem("start 0 0 0 0 0 0\nset_time now\n"), "E8001:2");
  EXPECT_EQ(problem("start 0 0 0 0 0 0\nsun_position 0 0 0\n"), "E8001:2");
  EXPECT_EQ(problem("start 0 0 0 0 0 0\nview craft\n"), "W8002:2");
  EXPECT_EQ(problem("start 0 0 0 0 0 0\n\nset_star 1\n"), "W8002:3");
  EXPECT_EQ(problem("start 0 0 0 0 0 0\n\nset_star 1\n", true), "E8001:3");
}

}  // namespace
}  // namespace panwright::scenario::fli_test
