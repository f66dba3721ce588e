// Views of the frames of a video, and its errors.
#include "studio/video.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "base/program.h"
#include "tests/support/process.h"

namespace panwright::studio {
namespace {

TEST(Video, TurntableGoesOnceAround) {
  ViewState view;
  view.camera.azimuth = 170;
  VideoSettings settings;
  settings.frames = 36;
  const std::vector<ViewState> views = video_views(view, settings, 1.5);
  ASSERT_EQ(views.size(), 36u);
  EXPECT_EQ(views[0].camera.azimuth, 170);
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_NEAR(std::remainder(views[i].camera.azimuth - 170 - 10.0 * static_cast<double>(i), 360),
                0, 1e-12);
    EXPECT_LE(std::fabs(views[i].camera.azimuth), 180);
    EXPECT_EQ(views[i].camera.range, view.camera.range);
    EXPECT_FALSE(views[i].auto_ev);
    EXPECT_EQ(views[i].ev, 1.5);
  }
}

TEST(Video, SweepGoesInEqualRatios) {
  ViewState view;
  view.camera.range = 4;
  VideoSettings settings;
  settings.kind = "range sweep";
  settings.frames = 11;
  settings.range = 4096;
  const std::vector<ViewState> views = video_views(view, settings, 0);
  ASSERT_EQ(views.size(), 11u);
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_NEAR(views[i].camera.range / std::exp2(2.0 + static_cast<double>(i)), 1, 1e-12);
    EXPECT_EQ(views[i].camera.azimuth, view.camera.azimuth);
  }
}

TEST(Video, FindsPrograms) {
  EXPECT_FALSE(find_program("sh").empty());
  EXPECT_TRUE(find_program("no such program").empty());
}

// Reports a folder that cannot be made, and an empty world.
TEST(Video, ReportsErrors) {
  const support::TemporaryFolder folder;
  folder.write("video-frames", "a file where the folder would be");
  Video video;
  ViewState view;
  const auto world = std::make_shared<const world::World>();
  const auto made = [&](const std::string& name) {
    video.start(
        {{}, folder / name, world, video_views(view, {}, 0), 64, 48, preview::ContextKind::osmesa});
    while (video.status().busy) std::this_thread::yield();
    return video.status().message;
  };
  EXPECT_NE(made("video.mp4").find("cannot be made"), std::string::npos);
  EXPECT_NE(made("other.mp4"), "");
  EXPECT_EQ(video.status().done, 0u);
  EXPECT_FALSE(std::filesystem::exists(folder / "other-frames"));
}

}  // namespace
}  // namespace panwright::studio
