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
#include <vector>

#include "base/math.h"
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

// Where the plate's rows show a point at first at time t, seconds after the frame.
Vec2 seen(double x0, double z0, bool upwards, double after) {
  const double slope = kUp * kLine * (upwards ? -1 : 1);
  const double y0 = kHeight / 2.0 - kPixels * z0 - kUp * (kTime + after - 1);
  const double y = (y0 - kUp * late(0, upwards)) / (1 + slope);
  return {kWidth / 2.0 + kPixels * x0 + kRight * (kTime + after - 1 + late(y, upwards)), y};
}

std::vector<float> flow_at(const std::string& file) {
  const std::string bytes = contents(file);
  std::vector<float> out((bytes.size() - 12) / 4);
  std::memcpy(out.data(), bytes.data() + 12, 4 * out.size());
  return out;
}

// Each point's place in its own row of both frames: all of the plate moves alike.
TEST_P(RollingLabels, FlowIsBetweenTheRowsThatShowAPoint) {
  const double sign = GetParam() ? -1 : 1;
  folder_.write("flow.toml", contents(folder_ / "run.toml") + "flow = true\n");
  const Outcome done =
      panwright({"run", folder_ / "flow.toml", "-o", folder_ / "flow", "--type", "npz", "--at",
                 fmt::format("{}", kTime), "--at", fmt::format("{}", kTime + 0.25), "--line-time",
                 fmt::format("{}", sign * kLine)});
  ASSERT_EQ(done.code, 0) << done.err;
  const Vec2 motion = seen(0.1, 0.2, GetParam(), 0.25) - seen(0.1, 0.2, GetParam(), 0);
  // without line times it would be
  const Vec2 at_once(0.25 * kRight, -0.25 * kUp);
  ASSERT_GT(glm::length(motion - at_once), 0.1);
  for (const char* file : {"flow/000000.forward.flo", "flow/000001.backward.flo"}) {
    const bool forward = std::string_view(file).find("forward") != std::string_view::npos;
    const std::vector<float> flow = flow_at(folder_ / file);
    ASSERT_EQ(flow.size(), 2u * kWidth * kHeight);
    std::size_t moved = 0;
    double worst = 0;
    for (std::size_t i = 0; i < flow.size(); i += 2) {
      if (flow[i] > 1e9f) continue;
      ++moved;
      const Vec2 found(double{flow[i]}, double{flow[i + 1]});
      worst = std::max(worst, glm::length(found - (forward ? motion : -motion)));
    }
    EXPECT_GT(moved, 200u) << file;
    EXPECT_LT(worst, 1e-5) << file;  // float32 depth and motion
  }
  const Outcome scanner = panwright({"run", folder_ / "flow.toml", "-o", folder_ / "no", "--at",
                                     "1", "--line-time", "0.001", "--tdi", "2"});
  EXPECT_NE(scanner.code, 0);
  EXPECT_NE(scanner.err.find("--tdi and flow cannot be combined"), std::string::npos);
}

// A line scanner shows a point in the row whose time it passes the middle of the lens: at one pixel
// a line a plate of 16 pixels keeps its height.
TEST_P(RollingLabels, OfALineScannerAreWhereItsRowsSeeThem) {
  const double sign = GetParam() ? -1 : 1;
  constexpr double kBegin = 0.7, kScan = 64;  // pixels a second, up for lines downwards
  folder_.write("way.csv",
                fmt::format("time[s],box.x[m],box.y[m],box.z[m]\n-2,{},0,{}\n4,{},0,{}\n",
                            -3 * kRight / kPixels, -3 * sign * kScan / kPixels,
                            3 * kRight / kPixels, 3 * sign * kScan / kPixels));
  for (const char* stages : {"1", "3"}) {
    const std::string out = folder_ / (std::string("scan") + stages);
    const Outcome done = panwright({"run", folder_ / "run.toml", "-o", out, "--type", "npz", "--at",
                                    fmt::format("{}", kBegin), "--tdi", stages, "--line-time",
                                    fmt::format("{}", sign * kLine)});
    ASSERT_EQ(done.code, 0) << done.err;
    const json frame = json::parse(contents(out + "/000000.labels.json"));
    const json& box = frame["things"][0];
    double left = kWidth, right = 0, top = kHeight, bottom = 0;
    for (int k = 0; k < 4; ++k) {
      const double z0 = 0.5 * kFaces[k][1], x0 = 0.5 * kFaces[k][0];
      const double time = 1 - sign * kPixels * z0 / kScan;  // in the middle of the lens
      const double line = (time - kBegin) / kLine;
      const double y = 0.5 + (GetParam() ? kHeight - 1 - line : line);
      const double x = kWidth / 2.0 + kPixels * x0 + kRight * (time - 1);
      const json& keypoint = box["keypoints"][static_cast<std::size_t>(k)];
      EXPECT_NEAR(keypoint["pixel"][0].get<double>(), x, 1e-9) << k;
      EXPECT_NEAR(keypoint["pixel"][1].get<double>(), y, 1e-9) << k;
      EXPECT_FALSE(keypoint["truncated"].get<bool>()) << k;
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
    }
    EXPECT_NEAR(bottom - top, 16, 1e-9);
    const double edges[] = {left, top, right, bottom};
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(box["amodal_box"][k].get<double>(), edges[k], k % 2 == 0 ? 0.3 : 1e-6) << k;
    EXPECT_NEAR(box["amodal_pixels"].get<double>(), 256, 2);
    EXPECT_EQ(box["amodal_pixels"], box["visible_pixels"]);
  }
  // what never passes is outside of the image
  const Outcome later =
      panwright({"run", folder_ / "run.toml", "-o", folder_ / "later", "--at", "1.5", "--tdi", "1",
                 "--line-time", fmt::format("{}", sign * kLine)});
  ASSERT_EQ(later.code, 0) << later.err;
  const json frame = json::parse(contents(folder_ / "later/000000.labels.json"));
  const json& box = frame["things"][0];
  EXPECT_EQ(box["visible_pixels"].get<double>(), 0);
  EXPECT_EQ(box["amodal_pixels"].get<double>(), 0);
  for (const json& keypoint : box["keypoints"]) EXPECT_TRUE(keypoint["truncated"].get<bool>());
}

}  // namespace
}  // namespace panwright::rolling_labels_test
