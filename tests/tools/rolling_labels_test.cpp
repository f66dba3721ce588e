// Labels of rolling shutters against closed forms, and against the ids of their images: a plate
// that moves before an orthographic camera, its rows exposed one after the other.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>

#include "image/arrays.h"
#include "tests/support/process.h"

namespace panwright::rolling_labels_test {
namespace {

using nlohmann::json;
using support::contents;
using support::Outcome;
using support::panwright;
using support::TemporaryFolder;

constexpr int kWidth = 64, kHeight = 48;
constexpr double kPixels = 16;                                      // per metre
constexpr double kRight = 16, kUp = 6;                              // pixels a second
constexpr double kTime = 1.0301;                                    // of the frame
constexpr double kLine = 1.0 / 64;                                  // seconds between rows
constexpr int kFaces[4][2] = {{-1, -1}, {-1, 1}, {1, -1}, {1, 1}};  // corners: right, up

// Time of a place's row, seconds after the frame.
double late(double y, bool upwards) {
  return kLine * (upwards ? kHeight - 1 - (y - 0.5) : y - 0.5);
}

class RollingLabels : public testing::TestWithParam<bool> {
 protected:
  const TemporaryFolder folder_;

  RollingLabels() {
    std::string model = "<pangu_model ver=\"1\">";
    for (int k = 0; k < 4; ++k)
      model += fmt::format("<keypoint name=\"k{}\" at=\"{} -0.5 {}\"/>", k, 0.5 * kFaces[k][0],
                           0.5 * kFaces[k][1]);
    folder_.write("box.pxn", model + "<box size=\"1\"/></pangu_model>");
    folder_.write(
        "way.csv",
        fmt::format("time[s],box.x[m],box.y[m],box.z[m]\n0,{},0,{}\n4,{},0,{}\n", -kRight / kPixels,
                    -kUp / kPixels, 3 * kRight / kPixels, 3 * kUp / kPixels));
    folder_.write("run.toml",
                  fmt::format("[targets]\nbox = \"box.pxn\"\n[[source]]\nfile = \"way.csv\"\n"
                              "[view]\nsize = [{}, {}]\northo = {}\ncamera = [0, -6, 0]\n"
                              "sun = [0, -1, 0]\nengine = \"reference\"\nsamples = 1\n[labels]\n",
                              kWidth, kHeight, kWidth / kPixels));
  }
};

INSTANTIATE_TEST_SUITE_P(Readouts, RollingLabels, testing::Bool(), [](const auto& one) {
  return one.param ? "FromTheBottom" : "FromTheTop";
});

TEST_P(RollingLabels, AreThoseOfTheRows) {
  const double sign = GetParam() ? -1 : 1;
  const Outcome done =
      panwright({"run", folder_ / "run.toml", "-o", folder_ / "out", "--type", "npz", "--at",
                 fmt::format("{}", kTime), "--line-time", fmt::format("{}", sign * kLine)});
  ASSERT_EQ(done.code, 0) << done.err;
  const json frame = json::parse(contents(folder_ / "out/000000.labels.json"));
  const json& box = frame["things"][0];
  // the pose is that of the frame's time
  EXPECT_NEAR(box["camera_from_thing"]["translation"][0].get<double>(),
              (kTime - 1) * kRight / kPixels, 1e-12);
  // y = y0 - up·late(y)
  double left = kWidth, right = 0, top = kHeight, bottom = 0;
  for (int k = 0; k < 4; ++k) {
    const double y0 = kHeight / 2.0 - kPixels * 0.5 * kFaces[k][1] - kUp * (kTime - 1);
    const double slope = kUp * kLine * sign;
    const double at_zero = late(0, GetParam());
    const double y = (y0 - kUp * at_zero) / (1 + slope);
    const double x =
        kWidth / 2.0 + kPixels * 0.5 * kFaces[k][0] + kRight * (kTime - 1 + late(y, GetParam()));
    const json& keypoint = box["keypoints"][static_cast<std::size_t>(k)];
    EXPECT_NEAR(keypoint["pixel"][0].get<double>(), x, 1e-9) << k;
    EXPECT_NEAR(keypoint["pixel"][1].get<double>(), y, 1e-9) << k;
    EXPECT_FALSE(keypoint["occluded"].get<bool>()) << k;
    EXPECT_FALSE(keypoint["truncated"].get<bool>()) << k;
    left = std::min(left, x), right = std::max(right, x);
    top = std::min(top, y), bottom = std::max(bottom, y);
  }
  // rows are of moments, between which the image moves by half a pixel
  const double edges[] = {left, top, right, bottom};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(box["amodal_box"][k].get<double>(), edges[k], 0.3) << k;
    EXPECT_NEAR(box["visible_box"][k].get<double>(), edges[k], 0.45) << k;
  }
  // height and width of what is stretched and sheared
  EXPECT_NEAR(box["amodal_pixels"].get<double>(), 16 * (bottom - top), 8);
  EXPECT_EQ(box["amodal_pixels"], box["visible_pixels"]);
  // masks are those of the image
  DiagnosticLog log;
  const auto ids = image::read_arrays(folder_ / "out/000000.npz",
                                      std::array{std::string_view("target_id")}, 1 << 20, log);
  const auto masks = image::read_arrays(folder_ / "out/000000.masks.npz", {}, 1 << 20, log);
  ASSERT_TRUE(ids && masks && ids->size() == 1 && masks->size() == 2);
  const json& place = box["visible"];
  const int mask_left = place["left"], mask_top = place["top"], width = place["width"],
            height = place["height"];
  int different = 0, shown = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      std::uint32_t id = 0;
      std::memcpy(&id, (*ids)[0].data.data() + 4 * (y * kWidth + x), 4);
      const bool inside =
          x >= mask_left && y >= mask_top && x < mask_left + width && y < mask_top + height;
      const int coverage = !inside ? 0
                                   : std::to_integer<int>((*masks)[1].data[static_cast<std::size_t>(
                                         (y - mask_top) * width + x - mask_left)]);
      shown += id != 0;
      // of whole pixels there is no doubt, and half covered ones have their centre on an edge
      if (coverage == 0 || coverage == 255) EXPECT_EQ(id != 0, coverage == 255) << x << " " << y;
      different += (coverage > 127) != (id != 0);
    }
  EXPECT_GT(shown, 200);
  EXPECT_LE(different, 4);
}

}  // namespace
}  // namespace panwright::rolling_labels_test
