// The eyes of a video's frames, and what becomes of them.
#include "studio/video.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "tests/support/process.h"

namespace panwright::studio {
namespace {

TEST(Video, ATurntableGoesOnceAround) {
  Eye eye;
  eye.azimuth = 170;
  VideoPlan plan;
  plan.frames = 36;
  const std::vector<Eye> eyes = video_eyes(eye, plan, 1.5);
  ASSERT_EQ(eyes.size(), 36u);
  EXPECT_EQ(eyes[0].azimuth, 170);
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    EXPECT_NEAR(std::remainder(eyes[i].azimuth - 170 - 10.0 * static_cast<double>(i), 360), 0,
                1e-12);
    EXPECT_LE(std::fabs(eyes[i].azimuth), 180);
    EXPECT_EQ(eyes[i].range, eye.range);
    EXPECT_FALSE(eyes[i].auto_ev);
    EXPECT_EQ(eyes[i].ev, 1.5);
  }
}

TEST(Video, ASweepGoesInEvenRatios) {
  Eye eye;
  eye.range = 4;
  VideoPlan plan;
  plan.kind = "range sweep";
  plan.frames = 11;
  plan.range = 4096;
  const std::vector<Eye> eyes = video_eyes(eye, plan, 0);
  ASSERT_EQ(eyes.size(), 11u);
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    EXPECT_NEAR(eyes[i].range / std::exp2(2.0 + static_cast<double>(i)), 1, 1e-12);
    EXPECT_EQ(eyes[i].azimuth, eye.azimuth);
  }
}

TEST(Video, FindsPrograms) {
  EXPECT_FALSE(find_program("sh").empty());
  EXPECT_TRUE(find_program("no such program").empty());
}

// A folder that cannot be made is said; so is a world without anything.
TEST(Video, SaysWhatGoesWrong) {
  const support::TemporaryFolder folder;
  folder.write("video-frames", "a file where the folder would be");
  Video video;
  Eye eye;
  const auto world = std::make_shared<const world::World>();
  const auto made = [&](const std::string& name) {
    video.make({}, folder / name, world, video_eyes(eye, {}, 0), 64, 48,
               preview::ContextKind::osmesa);
    while (video.status().busy) std::this_thread::yield();
    return video.status().words;
  };
  EXPECT_NE(made("video.mp4").find("cannot be made"), std::string::npos);
  EXPECT_NE(made("other.mp4"), "");
  EXPECT_EQ(video.status().done, 0u);
  EXPECT_FALSE(std::filesystem::exists(folder / "other-frames"));
}

}  // namespace
}  // namespace panwright::studio
