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

View small_view(const std::string& output) {
  View view;
  world::set_field_of_view(view.camera, 48, 32, 40 * kDegree);
  view.camera.position = {0, -5, 0};
  DiagnosticLog log;
  view.camera.world_from_camera = *world::looking_at({0, -5, 0}, {0, 0, 0}, std::nullopt, log);
  view.sun.emplace().direction = {-1, -2, 1};
  view.output = output;
  return view;
}

RunOptions traced() {
  RunOptions options;
  options.draw.engine = Engine::reference;
  options.draw.reference.samples = 8;
  return options;
}

TEST(RunViews, WritesWhatTheEngineDraws) {
  const TemporaryFolder folder;
  world::World world = small_world(folder);
  const Vec3 aside(1, 0, 0);
  std::vector<View> views;
  for (const char* name : {"a.npy", "b.npy", "c.npy"}) views.push_back(small_view(folder / name));
  views[0].poses = {{"ball", {-aside, {1, 0, 0, 0}}}};
  views[1].poses = {{"ball", {-2.0 * aside, {1, 0, 0, 0}}}, {"box", {aside, {1, 0, 0, 0}}}};
  views[2].sun->direction = {1, -1, 0};
  for (const std::size_t threads : {1u, 2u}) {
    RunOptions options = traced();
    std::vector<std::size_t> told;
    options.listener.written = [&](const Written& image) {
      told.push_back(image.view);
      EXPECT_EQ(image.width, 48u);
      EXPECT_EQ(image.unit, "1/sr");
      EXPECT_TRUE(image.measured);
      EXPECT_TRUE(fs::exists(image.output));
    };
    DiagnosticLog log;
    const auto written = run_views(world, views, options, log, Job({threads, {}}));
    ASSERT_TRUE(written) << to_text(log);
    EXPECT_EQ(*written, 3u);
    EXPECT_THAT(told, testing::ElementsAre(0, 1, 2));
    // each view by itself, from the world as it was: views leave nothing behind
    for (const View& view : views) {
      world::World posed = world;
      for (const TargetPose& each : view.poses) posed.set_pose(*posed.find(each.target), each.pose);
      posed.set_sun(*view.sun);
      auto drawer = Drawer::create(options.draw, log);
      ASSERT_TRUE(drawer);
      const auto drawn = drawer->draw(posed, view.camera, false, log);
      ASSERT_TRUE(drawn);
      const std::string alone = folder / "alone.npy";
      ASSERT_TRUE(image::write_image(alone, drawn->image, 0, log));
      EXPECT_TRUE(support::contents(alone) == support::contents(view.output)) << view.output;
    }
  }
  EXPECT_FALSE(support::contents(views[0].output) == support::contents(views[2].output));
}

TEST(RunViews, SaysWhatIsWrongBeforeAnythingIsDrawn) {
  const TemporaryFolder folder;
  const world::World world = small_world(folder);
  const auto code = [&](const world::World& of, const View& bad) {
    const std::vector<View> views = {small_view(folder / "good.png"), bad};
    DiagnosticLog log;
    EXPECT_FALSE(run_views(of, views, traced(), log));
    EXPECT_FALSE(fs::exists(folder / "good.png"));
    return log.entries().empty() ? Code::E0101 : log.entries()[0].code;
  };
  EXPECT_EQ(code({}, small_view(folder / "b.png")), Code::E5030);
  EXPECT_EQ(code(world, small_view(folder / "b.gif")), Code::E0202);
  View posed = small_view(folder / "b.png");
  posed.poses = {{"bal", {}}};
  EXPECT_EQ(code(world, posed), Code::E5011);
}

TEST(RunViews, StopsAtAnImageThatCannotBeWrittenAndKeepsTheOthers) {
  const TemporaryFolder folder;
  const world::World world = small_world(folder);
  fs::create_directory(folder / "b.png");
  const std::vector<View> views = {small_view(folder / "a.png"), small_view(folder / "b.png"),
                                   small_view(folder / "c.png"), small_view(folder / "d.png")};
  DiagnosticLog log;
  EXPECT_FALSE(run_views(world, views, traced(), log));
  EXPECT_TRUE(log.contains(Code::E0103));
  EXPECT_TRUE(fs::exists(folder / "a.png"));
  EXPECT_FALSE(fs::exists(folder / "d.png"));
}

TEST(RunViews, BeginsNothingWhereAFolderIsMissing) {
  const TemporaryFolder folder;
  const world::World world = small_world(folder);
  const std::vector<View> views = {small_view(folder / "a.png"), small_view(folder / "no/b.png")};
  DiagnosticLog log;
  EXPECT_FALSE(run_views(world, views, traced(), log));
  EXPECT_TRUE(log.contains(Code::E0103));
  EXPECT_FALSE(fs::exists(folder / "a.png"));
}

TEST(RunViews, NamesTheTargetsInTheHeader) {
  const TemporaryFolder folder;
  const world::World world = small_world(folder);
  View view = small_view(folder / "a.exr");
  view.poses = {{"box", {{1, 2.5, 0}, {0, 0, 0, 1}}}};
  DiagnosticLog log;
  ASSERT_TRUE(run_views(world, {&view, 1}, traced(), log)) << to_text(log);
  const std::string bytes = support::contents(view.output);
  for (const std::string& part :
       {std::string("panwright.targets"), std::string("ball\nbox"),
        std::string("panwright.pose.box"), std::string("1 2.5 0 0 0 0 1"),
        std::string("panwright.build_id.ball"), world[0].model()->build_id().hex()})
    EXPECT_NE(bytes.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace panwright::workspace::run_test
