// Keyframes: members, curves and problems with their places.
#include "scenario/keyframes.h"

#include <gtest/gtest.h>

#include "tests/scenario/support.h"

namespace panwright::scenario::keyframes_test {
namespace {

using support::at;
using support::codes;
using support::first_line;

SourcePtr read(const std::string& text) {
  DiagnosticLog log;
  auto source = read_keyframes(memory_text("t.json", text), {}, log);
  EXPECT_TRUE(source) << to_text(log);
  EXPECT_EQ(codes(log), "");
  return source ? *source : nullptr;
}

std::string problem(const std::string& text, bool strict = false) {
  DiagnosticLog log;
  const auto source = read_keyframes(memory_text("t.json", text), {strict}, log);
  EXPECT_EQ(source.ok(), !log.has_errors());
  return codes(log) + ":" + std::to_string(first_line(log));
}

// The problem of a second keyframe with a member, on line 3.
std::string with(const std::string& member) {
  return problem("{\"keyframes\": [\n{\"time\": 0, \"camera\": [0, 0, 0]},\n{\"time\": 1, " +
                 member + "}]}");
}

TEST(Keyframes, Members) {
  const auto source = read(
      "{\"epoch\": \"2026-01-01T00:00:00 TAI\", \"keyframes\": [\n"
      "{\"time\": 0, \"camera\": [0, -10, 0], \"look_at\": [0, 0, 0], \"fov\": 20,\n"
      " \"joint\": {\"a/wing\": \"30deg\", \"a/arm\": [\"1rad\", \"20cm\", \"2x\"]},\n"
      " \"sun\": [0, 0, 3], \"sun_distance\": 1.5, \"name\": \"caf\\u00e9\", \"seed\": 4},\n"
      "{\"time\": 10, \"pose\": {\"a\": [1, 2, 3, 1, 0, 0, 0], \"b\": [4, 5, 6]}},\n"
      "{\"time\": 20, \"camera\": [0, -10, 10], \"fov\": \"0.5rad\"}]}");
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().times, (std::vector<double>{0, 10, 20}));
  EXPECT_EQ(epoch_text(*source->info().epoch, TimeSystem::tai), "2026-01-01T00:00:00");
  const Frame first = at(*source, 0);
  EXPECT_EQ(first.name, "caf\xc3\xa9");
  EXPECT_EQ(first.seed, 4u);
  EXPECT_EQ(first.sun_direction, Vec3(0, 0, 1));
  EXPECT_EQ(first.find("a")->placement.position, Vec3(1, 2, 3));  // constant before its first key
  EXPECT_FALSE(first.find("b")->placement.rotation);
  EXPECT_EQ(first.find("a")->joints.at(0).values[0], 30 * kDegree);
  EXPECT_EQ(first.find("a")->joints.at(1).count, 3u);
  EXPECT_EQ(first.find("a")->joints.at(1).values[1], 0.2);
  EXPECT_EQ(first.find("a")->joints.at(1).values[2], 2);
  const Frame middle = at(*source, 10);
  EXPECT_EQ(middle.camera.position, Vec3(0, -10, 5));
  // it looks at the point all the way, not only at keys
  EXPECT_LT(length(*middle.camera.rotation * Vec3(0, 0, 1) - normalize(Vec3(0, 10, -5))), 1e-15);
  EXPECT_NEAR(*middle.lens.fov, (20 * kDegree + 0.5) / 2, 1e-15);
  EXPECT_EQ(middle.name, "");
}

// Between keys the camera may meet the point that it looks at: no rotation is made up.
TEST(Keyframes, CameraOnItsPoint) {
  const auto source = read(
      "{\"interpolation\": \"linear\", \"keyframes\": [{\"time\": 0, \"camera\": [0, -1, 0], "
      "\"look_at\": [0, 0, 0]}, {\"time\": 2, \"camera\": [0, 1, 0]}]}");
  Frame frame;
  DiagnosticLog log;
  EXPECT_TRUE(source->at(0.5, frame, log));
  EXPECT_FALSE(source->at(1, frame, log));
  EXPECT_EQ(codes(log), "E8003");
}

TEST(Keyframes, CubicAndLinear) {
  const std::string keys =
      "\"keyframes\": [{\"time\": 0, \"camera\": [0, 0, 0]}, {\"time\": 1, \"camera\": [1, 1, 0]}, "
      "{\"time\": 3, \"camera\": [3, 9, 0]}]}";
  // y = t² by the parabola through the keys
  EXPECT_LT(length(*at(*read("{" + keys), 2).camera.position - Vec3(2, 4, 0)), 1e-14);
  EXPECT_EQ(at(*read("{\"interpolation\": \"linear\", " + keys), 2).camera.position, Vec3(2, 5, 0));
}

TEST(Keyframes, Problems) {
  EXPECT_EQ(problem(""), "E8001:1");
  EXPECT_EQ(problem("[]"), "E8001:1");
  EXPECT_EQ(problem("{}"), "E8001:1");
  EXPECT_EQ(problem("{\"keyframes\": []}"), "E8001:1");
  EXPECT_EQ(problem("{\"keyframes\": [\n{\"time\": 0,}]}"), "E8001:2");
  EXPECT_EQ(problem("{\"keyframes\": [\n1]}"), "E8001:2");
  EXPECT_EQ(problem("{\"keyframes\": [{\"time\": 0}]} x"), "E8001:1");
  EXPECT_EQ(problem("{\"epoch\": \"2026-01-01T00:00:00\", \"keyframes\": [{\"time\": 0}]}"),
            "E8007:1");
  EXPECT_EQ(problem("{\"interpolation\": \"none\", \"keyframes\": [{\"time\": 0}]}"), "E8001:1");
  EXPECT_EQ(problem("{\"keyframes\": [\n{\"time\": 1, \"camera\": [0,0,0]},\n{\"time\": 1}]}"),
            "E8004:3");
  EXPECT_EQ(with("\"camera\": [0, 1, 0]"), ":0");
  EXPECT_EQ(with("\"camera\": [0, 1]"), "E8001:3");
  EXPECT_EQ(with("\"camera\": [0, 1, null]"), "E8001:3");
  EXPECT_EQ(with("\"camera\": [0, 1, 1e999]"), "E8001:3");
  EXPECT_EQ(with("\"camera\": [0, 1, 0], \"camera\": [0, 1, 0]"), "E8001:3");
  EXPECT_EQ(with("\"camera\": [0, 1, 0], \"look_at\": [0, 1, 0]"), "E8001:3");
  EXPECT_EQ(with("\"look_at\": [0, 1, 0], \"quat\": [1, 0, 0, 0]"), "E8008:3");
  EXPECT_EQ(with("\"quat\": [0, 0, 0, 0]"), "E8005:3");
  EXPECT_EQ(with("\"quat\": [0.9, 0, 0, 0]"), "W8006:3");
  EXPECT_EQ(with("\"pose\": [0, 0, 0]"), "E8001:3");
  EXPECT_EQ(with("\"pose\": {\"a\": [0, 0, 0, 0, 0, 0, 0]}"), "E8005:3");
  EXPECT_EQ(with("\"joint\": {\"wing\": \"30deg\"}"), "E8001:3");
  EXPECT_EQ(with("\"joint\": {\"a/wing\": 30}"), "E8001:3");
  EXPECT_EQ(with("\"joint\": {\"a/wing\": \"30\"}"), "E8001:3");
  EXPECT_EQ(with("\"joint\": {\"a/wing\": []}"), "E8001:3");
  EXPECT_EQ(with("\"sun\": [0, 0, 0]"), "E8001:3");
  EXPECT_EQ(with("\"sun_distance\": 0"), "E8001:3");
  EXPECT_EQ(with("\"fov\": 180"), "E8001:3");
  EXPECT_EQ(with("\"fov\": \"20m\""), "E8001:3");
  EXPECT_EQ(with("\"seed\": 1.5"), "E8001:3");
  EXPECT_EQ(with("\"name\": 5"), "E8001:3");
  EXPECT_EQ(with("\"colour\": 5"), "W8002:3");
  EXPECT_EQ(problem("{\"keyframes\": [{\"time\": 0, \"x\": 1}]}", true), "E8001:1");
  EXPECT_EQ(problem(std::string(100000, '[')), "E8001:1");
  EXPECT_EQ(problem("{\"keyframes\": [{\"time\": 0, \"name\": \"\\ud800\"}]}"), "E8001:1");
}

// ---- views

SourcePtr views(const std::string& text) {
  DiagnosticLog log;
  auto source = read_views(memory_text("t.jsonl", text), {}, log);
  EXPECT_TRUE(source) << to_text(log);
  EXPECT_EQ(codes(log), "");
  return source ? *source : nullptr;
}

std::string problem_of_views(const std::string& text) {
  DiagnosticLog log;
  const bool read = read_views(memory_text("t.jsonl", text), {}, log).ok();
  EXPECT_EQ(read, !log.has_errors());
  return codes(log) + ":" + std::to_string(first_line(log));
}

Frame frame(const Source& source, std::size_t index) {
  Frame out;
  DiagnosticLog log;
  EXPECT_TRUE(source.frame(index, out, log)) << to_text(log);
  return out;
}

TEST(ViewsSource, FramesByTheirOrder) {
  const auto source = views(
      "{\"name\": \"a\", \"camera\": [0, -10, 0], \"look-at\": [0, 0, 0], \"intrinsics\": \"20 21 "
      "5 6\",\n"
      " \"pose\": {\"box\": [1, 2, 3, 1, 0, 0, 0]}, \"joint\": {\"box/lid\": \"90deg\"}, \"sun\": "
      "[0, 0, 2]}\n"
      "{\"name\": \"b\", \"camera\": \"0 0, -5\", \"quat\": [1, 0, 0, 0], \"intrinsics\": [30, 31, "
      "7, 8],\n"
      " \"pose\": {\"box\": [4, 5, 6, 0, 1, 0, 0]}, \"joint\": {\"box/lid\": \"1rad\"}, \"sun\": "
      "[1, 0, 0]}\n");
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().ordered, 2u);
  const Frame first = frame(*source, 0), second = frame(*source, 1);
  EXPECT_EQ(first.name, "a");
  EXPECT_EQ(first.camera.position, Vec3(0, -10, 0));
  // the boresight is +y, x stays to the right
  EXPECT_LT(length(*first.camera.rotation * Vec3(0, 0, 1) - Vec3(0, 1, 0)), 1e-15);
  EXPECT_LT(length(*first.camera.rotation * Vec3(1, 0, 0) - Vec3(1, 0, 0)), 1e-15);
  EXPECT_EQ(first.lens.focal, Vec2(20, 21));
  EXPECT_EQ(first.lens.principal, Vec2(5, 6));
  EXPECT_EQ(first.find("box")->joints.at(0).values[0], 90 * kDegree);
  EXPECT_EQ(first.sun_direction, Vec3(0, 0, 1));
  EXPECT_EQ(second.camera.position, Vec3(0, 0, -5));
  EXPECT_EQ(second.camera.rotation, Quat(1, 0, 0, 0));
  EXPECT_EQ(second.find("box")->placement.position, Vec3(4, 5, 6));
  EXPECT_EQ(second.find("box")->placement.rotation, Quat(0, 1, 0, 0));
  EXPECT_EQ(second.sun_direction, Vec3(1, 0, 0));
}

TEST(ViewsSource, FramesByTime) {
  const auto source = views(
      "[{\"time\": 2, \"camera\": [0, 0, 0], \"quat\": [1, 0, 0, 0]},\n"
      "{\"time\": 4, \"camera\": [2, 0, 0], \"quat\": [0.6, 0, 0, 0.8]}]");
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().times, (std::vector<double>{2, 4}));
  const Frame middle = at(*source, 3);
  EXPECT_EQ(middle.camera.position, Vec3(1, 0, 0));
  // half of that turn about z: cos² = (1 + 0.6)/2. Measured: 1.1e-16
  EXPECT_LT(
      support::turn_between(*middle.camera.rotation, Quat(std::sqrt(0.8), 0, 0, std::sqrt(0.2))),
      1e-15);
}

TEST(ViewsSource, Problems) {
  const std::string one = "{\"camera\": [0, -1, 0]}\n";
  EXPECT_EQ(problem_of_views(""), "E8001:1");
  EXPECT_EQ(problem_of_views("[]"), "E8001:1");
  EXPECT_EQ(problem_of_views(one + "5"), "E8001:2");
  EXPECT_EQ(problem_of_views(one + "{\"camera\": [0, -1, 0]"), "E8001:2");
  EXPECT_EQ(problem_of_views(one + one), ":0");
  EXPECT_EQ(problem_of_views(one + "{}"), "E8001:2");
  EXPECT_EQ(problem_of_views(one + "{\"camera\": [0, -1, 0], \"sun\": [1, 0, 0]}"), "E8001:2");
  EXPECT_EQ(problem_of_views(one + "{\"camera\": [0, -1, 0], \"time\": 1}"), "E8001:2");
  EXPECT_EQ(problem_of_views(one + "{\"camera\": [0, -1, 0], \"seed\": 1}"), "E8001:2");
  EXPECT_EQ(problem_of_views(one + "{\"camera\": \"0 -1\"}"), "E8001:2");
  EXPECT_EQ(problem_of_views(one + "{\"camera\": \"0 -1 0 2\"}"), "E8001:2");
  EXPECT_EQ(problem_of_views(one + "{\"camera\": \"0 -1 x\"}"), "E8001:2");
  EXPECT_EQ(problem_of_views("{\"look-at\": [0, 0, 0]}"), "E8001:1");
  EXPECT_EQ(problem_of_views("{\"camera\": [0, 0, 0],\n\"look-at\": [0, 0, 0]}"), "E8001:1");
  EXPECT_EQ(problem_of_views("{\"intrinsics\": [0, 1, 2, 3]}"), "E8001:1");
  EXPECT_EQ(problem_of_views("{\"time\": 1}\n{\"time\": 1}"), "E8004:2");
  EXPECT_EQ(problem_of_views("{\"quat\": [0, 0, 0, 0]}"), "E8005:1");
  // settings stand in the scenario: once for each name
  const std::string more = "{\"camera\": [0, -1, 0], \"output\": \"a.png\"}\n";
  EXPECT_EQ(problem_of_views(more + more), "W8002:1");
}

}  // namespace
}  // namespace panwright::scenario::keyframes_test
