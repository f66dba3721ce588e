// Scenarios in the window: what they open, and the lines of tracks against projected points.
#include "studio/play.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <string>
#include <thread>

#include "scenario/formulas.h"
#include "studio/project.h"
#include "studio/tracks.h"
#include "tests/support/process.h"

namespace panwright::studio::play_test {
namespace {

const std::string kBox = "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>\n";
const std::string kWay =
    "time[s],camera.x[m],camera.y[m],camera.z[m],box.x[m],box.y[m],box.z[m]\n"
    "0,0,-10,0,0,0,0\n10,0,-20,0,1,0,0\n20,5,-30,0,3,0,0\n";
const std::string kScenario =
    "look_at = \"box\"\n[targets]\nbox = \"box.pxn\"\n[[source]]\nfile = \"way.csv\"\n";

bool reaches(const Project& project, const std::function<bool(const Project::State&)>& what) {
  for (int i = 0; i < 3000; ++i) {
    if (what(project.state())) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

TEST(Play, TheProjectReadsItAndWhatItNames) {
  const support::TemporaryFolder folder;
  folder.write("box.pxn", kBox);
  folder.write("way.csv", kWay);
  const std::string scenario = folder.write("pass.toml", kScenario);
  Project project({scenario}, {});
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.world && !s.reading; }));
  const auto first = project.state();
  ASSERT_TRUE(first.play);
  EXPECT_FALSE(first.failed);
  EXPECT_EQ(first.play->times, (std::vector<double>{0, 10, 20}));
  EXPECT_EQ(first.targets.size(), 1u);
  EXPECT_EQ(first.watched.size(), 3u);
  ASSERT_EQ(first.play->tracks.size(), 2u);
  EXPECT_EQ(first.play->tracks[0].target, "");
  EXPECT_EQ(first.play->tracks[0].points[2], Vec3(5, -30, 0));
  EXPECT_EQ(first.play->tracks[1].target, "box");
  EXPECT_EQ(first.play->tracks[1].numbers, (std::vector<std::uint64_t>{0, 1, 2}));

  // a mistake of the trajectory has its line, and the last version stays
  folder.write("way.csv", kWay + "30,x,0,0,0,0,0\n");
  ASSERT_TRUE(reaches(project, [](const auto& s) { return s.failed; }));
  EXPECT_EQ(project.state().play, first.play);
  ASSERT_FALSE(project.state().messages.empty());
  EXPECT_EQ(project.state().messages[0].line, 5u);
  folder.write("way.csv", kWay + "30,0,-40,0,3,0,0\n");
  ASSERT_TRUE(reaches(project, [](const auto& s) { return !s.failed && !s.reading; }));
  EXPECT_EQ(project.state().play->times.size(), 4u);
}

// Models beside a scenario: in place of one of the same name, or further ones.
TEST(Play, ModelsBesideIt) {
  const support::TemporaryFolder folder;
  folder.write("box.pxn", kBox);
  folder.write("way.csv", kWay);
  const std::string scenario = folder.write("pass.toml", kScenario);
  DiagnosticLog log;
  const auto play = open_play(scenario, "", {"box=other.pxn", "more=more.pxn"}, "", log);
  ASSERT_TRUE(play);
  EXPECT_EQ(play->targets, (std::vector<std::string>{"box=other.pxn", "more=more.pxn"}));
  EXPECT_FALSE(open_play(folder / "way.csv", "", {}, "", log));
  EXPECT_TRUE(log.contains(Code("E8013")));
}

struct Scene {
  Play play;
  Moment moment;
  world::Camera camera;
};

// A camera at (0, -10, 0) that looks along +y, seen from (40, -10, 0) along -x.
Scene scene(const std::vector<Vec3>& points) {
  Track track;
  for (std::size_t k = 0; k < points.size(); ++k) {
    track.numbers.push_back(10 * k);
    track.points.push_back(points[k]);
  }
  DiagnosticLog log;
  Scene out{{"",
             {*scenario::Sequence::of({{scenario::fixed_source("none", {}), 0}}, {}, log),
              {},
              {},
              {},
              {},
              {},
              {}},
             {},
             {},
             {track}},
            {},
            {}};
  world::Camera own;
  world::set_field_of_view(own, 200, 100, 60 * kDegree);
  own.position = {0, -10, 0};
  own.world_from_camera = *world::looking_at(own.position, Vec3(0), {}, log);
  out.moment.frame.instrument = workspace::CameraInstrument(own);
  world::set_field_of_view(out.camera, 400, 300, 50 * kDegree);
  out.camera.position = {40, -10, 0};
  out.camera.world_from_camera = *world::looking_at(out.camera.position, {0, -10, 0}, {}, log);
  return out;
}

double distance(const Vec2& a, const Vec2& b) { return glm::length(a - b); }

TEST(TrackLines, FieldOfViewReachesTheTargets) {
  const Scene scene = play_test::scene({{0, -10, 0}});
  const auto lines = track_lines(scene.camera, scene.play, scene.moment, Vec3(0, 0, 0));
  // a corner: 10 m ahead, half the width 10·tan(30°), half the height half of that
  const double half = 10 * std::tan(30 * kDegree);
  const Vec2 apex = *world::project(scene.camera, {0, -10, 0});
  int corners = 0;
  for (const double x : {-half, half})
    for (const double z : {-half / 2, half / 2}) {
      const Vec2 corner = *world::project(scene.camera, {x, 0, z});
      for (const TrackLine& line : lines)
        corners += distance(line.from, apex) < 1e-9 && distance(line.to, corner) < 1e-9;
    }
  EXPECT_EQ(corners, 4);
  // the tip is above the image: at 1.3 times half the height
  const Vec2 tip = *world::project(scene.camera, {0, 0, 1.3 * half / 2});
  int tips = 0;
  for (const TrackLine& line : lines) tips += distance(line.to, tip) < 1e-9;
  EXPECT_EQ(tips, 1);
}

TEST(TrackLines, PastAndFutureMeetAtTheCamera) {
  Scene scene = play_test::scene({{0, -14, 0}, {0, -6, 0}});
  scene.moment.number = 5;  // between the points, of frames 0 and 10
  const auto lines = track_lines(scene.camera, scene.play, scene.moment, Vec3(0));
  const Vec2 apex = *world::project(scene.camera, {0, -10, 0});
  ASSERT_GE(lines.size(), 2u);
  EXPECT_EQ(lines[0].kind, TrackLine::Kind::past);
  EXPECT_LT(distance(lines[0].from, *world::project(scene.camera, {0, -14, 0})), 1e-9);
  EXPECT_LT(distance(lines[0].to, apex), 1e-9);
  EXPECT_EQ(lines[1].kind, TrackLine::Kind::future);
  EXPECT_LT(distance(lines[1].from, apex), 1e-9);
}

// A track from behind the viewer to far outside of the image: what is left lies on the line of its
// visible points, within the image.
TEST(TrackLines, AreClippedToTheImage) {
  Scene scene = play_test::scene({{80, -11, 1}, {-1e9, -11, 1}});
  scene.moment.number = 10;
  const auto lines = track_lines(scene.camera, scene.play, scene.moment, Vec3(0));
  ASSERT_FALSE(lines.empty());
  const TrackLine& line = lines[0];
  ASSERT_EQ(line.kind, TrackLine::Kind::past);
  for (const Vec2& end : {line.from, line.to}) {
    EXPECT_GE(end.x, -1e-6);
    EXPECT_LE(end.x, 400 + 1e-6);
    EXPECT_GE(end.y, -1e-6);
    EXPECT_LE(end.y, 300 + 1e-6);
  }
  const Vec2 a = *world::project(scene.camera, {30, -11, 1}),
             b = *world::project(scene.camera, {-200, -11, 1});
  const Vec2 along = glm::normalize(b - a);
  for (const Vec2& end : {line.from, line.to}) {
    const Vec2 way = end - a;
    EXPECT_LT(std::fabs(way.x * along.y - way.y * along.x), 1e-6);
  }
  // behind the viewer there is nothing
  Scene behind = play_test::scene({{80, -11, 1}, {60, -11, 1}});
  for (const TrackLine& each : track_lines(behind.camera, behind.play, behind.moment, Vec3(0)))
    EXPECT_EQ(each.kind, TrackLine::Kind::field_of_view);
}

}  // namespace
}  // namespace panwright::studio::play_test
