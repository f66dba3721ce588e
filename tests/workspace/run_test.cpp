#include "workspace/run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "image/image.h"
#include "tests/support/process.h"

namespace panwright::workspace::run_test {
namespace {

namespace fs = std::filesystem;
using support::TemporaryFolder;

// A ball and a box, seen from −y.
world::World small_world(const TemporaryFolder& folder) {
  const TargetFile files[] = {
      {"ball",
       folder.write("ball.pxn", "<pangu_model ver=\"1\"><sphere radius=\"0.5\"/></pangu_model>")},
      {"box", folder.write("box.pxn", "<pangu_model ver=\"1\"><box size=\"0.8\"/></pangu_model>")}};
  DiagnosticLog log;
  const auto world = open_world(files, {}, log);
  EXPECT_TRUE(world) << to_text(log);
  return world ? *world : world::World();
}

Frame small_frame(const std::string& output) {
  Frame view;
  view.settings.engine = Engine::reference;
  view.settings.samples = 1;  // the least, 8 a pixel
  world::set_field_of_view(view.camera(), 48, 32, 40 * kDegree);
  view.camera().position = {0, -5, 0};
  DiagnosticLog log;
  view.camera().world_from_camera = *world::looking_at({0, -5, 0}, {0, 0, 0}, std::nullopt, log);
  view.sun.emplace().direction = {-1, -2, 1};
  view.outputs = {output};
  return view;
}

TEST(RunFrames, WritesWhatTheEngineDraws) {
  const TemporaryFolder folder;
  world::World world = small_world(folder);
  const Vec3 aside(1, 0, 0);
  std::vector<Frame> views;
  for (const char* name : {"a.npy", "b.npy", "c.npy"}) views.push_back(small_frame(folder / name));
  views[0].poses = {{"ball", {-aside, {1, 0, 0, 0}}}};
  views[1].poses = {{"ball", {-2.0 * aside, {1, 0, 0, 0}}}, {"box", {aside, {1, 0, 0, 0}}}};
  views[2].sun->direction = {1, -1, 0};
  for (const std::size_t threads : {1u, 2u}) {
    RunOptions options;
    std::vector<std::size_t> told;
    options.listener.written = [&](const Written& image) {
      told.push_back(image.frame);
      EXPECT_EQ(image.width, 48u);
      EXPECT_EQ(image.unit, "1/sr");
      EXPECT_TRUE(image.measured);
      EXPECT_TRUE(fs::exists(image.outputs[0]));
    };
    DiagnosticLog log;
    const auto written = run_frames(world, views, options, log, Job({threads, {}}));
    ASSERT_TRUE(written) << to_text(log);
    EXPECT_EQ(*written, 3u);
    EXPECT_THAT(told, testing::ElementsAre(0, 1, 2));
    // each view by itself, from the world as it was: views leave nothing behind
    for (const Frame& view : views) {
      world::World posed = world;
      for (const TargetPose& each : view.poses) posed.set_pose(*posed.find(each.target), each.pose);
      posed.set_sun(*view.sun);
      Drawer drawer(draw_options(view.settings, {}));
      const auto drawn = drawer.draw(posed, view.camera(), false, log);
      ASSERT_TRUE(drawn);
      const std::string alone = folder / "alone.npy";
      ASSERT_TRUE(image::write_image(alone, drawn->image, 0, log));
      EXPECT_TRUE(support::contents(alone) == support::contents(view.outputs[0]))
          << view.outputs[0];
    }
  }
  EXPECT_FALSE(support::contents(views[0].outputs[0]) == support::contents(views[2].outputs[0]));
}

TEST(RunFrames, SaysWhatIsWrongBeforeAnythingIsDrawn) {
  const TemporaryFolder folder;
  const world::World world = small_world(folder);
  const auto code = [&](const world::World& of, const Frame& bad) {
    const std::vector<Frame> views = {small_frame(folder / "good.png"), bad};
    DiagnosticLog log;
    EXPECT_FALSE(run_frames(of, views, {}, log));
    EXPECT_FALSE(fs::exists(folder / "good.png"));
    return log.entries().empty() ? Code("E0101") : log.entries()[0].code;
  };
  EXPECT_EQ(code({}, small_frame(folder / "b.png")), Code("E5030"));
  EXPECT_EQ(code(world, small_frame(folder / "b.gif")), Code("E0202"));
  Frame posed = small_frame(folder / "b.png");
  posed.poses = {{"bal", {}}};
  EXPECT_EQ(code(world, posed), Code("E5011"));
}

TEST(RunFrames, StopsAtAnImageThatCannotBeWrittenAndKeepsTheOthers) {
  const TemporaryFolder folder;
  const world::World world = small_world(folder);
  fs::create_directory(folder / "b.png");
  const std::vector<Frame> views = {small_frame(folder / "a.png"), small_frame(folder / "b.png"),
                                    small_frame(folder / "c.png"), small_frame(folder / "d.png")};
  DiagnosticLog log;
  EXPECT_FALSE(run_frames(world, views, {}, log));
  EXPECT_TRUE(log.contains(Code("E0103")));
  EXPECT_TRUE(fs::exists(folder / "a.png"));
  EXPECT_FALSE(fs::exists(folder / "d.png"));
}

TEST(RunFrames, BeginsNothingWhereAFolderIsMissing) {
  const TemporaryFolder folder;
  const world::World world = small_world(folder);
  const std::vector<Frame> views = {small_frame(folder / "a.png"),
                                    small_frame(folder / "no/b.png")};
  DiagnosticLog log;
  EXPECT_FALSE(run_frames(world, views, {}, log));
  EXPECT_TRUE(log.contains(Code("E0103")));
  EXPECT_FALSE(fs::exists(folder / "a.png"));
}

TEST(RunFrames, NamesTheTargetsInTheHeader) {
  const TemporaryFolder folder;
  const world::World world = small_world(folder);
  Frame view = small_frame(folder / "a.exr");
  view.poses = {{"box", {{1, 2.5, 0}, {0, 0, 0, 1}}}};
  DiagnosticLog log;
  ASSERT_TRUE(run_frames(world, {&view, 1}, {}, log)) << to_text(log);
  const std::string bytes = support::contents(view.outputs[0]);
  for (const std::string& part :
       {std::string("panwright.targets"), std::string("ball\nbox"),
        std::string("panwright.pose.box"), std::string("1 2.5 0 0 0 0 1"),
        std::string("panwright.build_id.ball"), world[0].model()->build_id().hex()})
    EXPECT_NE(bytes.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace panwright::workspace::run_test
