#include "server/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <string>

#include "base/file.h"
#include "tests/support/process.h"
#include "tests/support/terrain_models.h"
#include "workspace/settings.h"

namespace panwright::server {
namespace {

using support::TemporaryFolder;
using workspace::SettingId;

// A slab whose top is the plane z = 1, and a small box on a slide, whose top is z = 0.25.
constexpr const char* kScene = R"(<pangu_model ver="1" units="m">
  <material name="white"><diffuse>0.8 0.8 0.8</diffuse></material>
  <node name="slab"><box size="4 4 2" material="white"/></node>
  <joint name="slide" type="prismatic" axis="1 0 0" lower="0" upper="3">
    <box size="0.5 0.5 0.5" translate="5 0 0" material="white"/>
  </joint>
  <joint name="turn" type="revolute" axis="0 0 1" lower="-180deg" upper="180deg">
    <box size="0.1 0.1 0.1" translate="0 -9 0" material="white"/>
  </joint>
  <frame name="mast" translate="0 0 5" forward="0 0 -1" up="0 1 0"/>
</pangu_model>
)";

constexpr double kEye = 11;  // metres above the origin; 10 above the slab
constexpr double kFov = 30;  // degrees

class SessionTest : public testing::Test {
 protected:
  void SetUp() override {
    StageOptions options;
    options.targets = {"craft=" + folder_.write("craft.pxn", kScene)};
    for (const auto& [id, value] :
         {std::pair(SettingId::size, "32x32"), std::pair(SettingId::fov, "30"),
          std::pair(SettingId::engine, "reference"), std::pair(SettingId::samples, "1"),
          std::pair(SettingId::sun, "0 0 1")})
      ASSERT_TRUE(workspace::read_setting(id, value, options.defaults, log_));
    auto stage = Stage::open(options, log_, {});
    ASSERT_TRUE(stage) << to_text(log_);
    stage_ = *std::move(stage);
    session_ = std::make_unique<Session>(*stage_, std::make_shared<State>(stage_->initial()),
                                         SessionOptions{});
    ask(WireWriter()
            .word(269)
            .real64(0)
            .real64(0)
            .real64(kEye)
            .real64(0)
            .real64(1)
            .real64(0)
            .real64(0),
        reply::kOkay);
  }

  // The reply after its code, which is checked.
  Bytes ask(WireWriter request, std::uint32_t code) {
    const Bytes bytes = request.take();
    EXPECT_EQ(request_size(bytes, 1 << 20).state, RequestSize::State::complete);
    Reply reply = session_->answer(bytes, {});
    note_ = reply.note;
    EXPECT_GE(reply.bytes.size(), 4u);
    EXPECT_EQ(word_at(reply.bytes), code) << reply.note;
    return {reply.bytes.begin() + 4, reply.bytes.end()};
  }

  // Numbers of a reply, each of `size` bytes of which 4 are a float and the others are skipped.
  static std::vector<double> floats(const Bytes& bytes, std::size_t from, std::size_t step = 4) {
    std::vector<double> out;
    for (std::size_t at = from; at + 4 <= bytes.size(); at += step)
      out.push_back(unpacked(word_at(std::span(bytes).subspan(at))));
    return out;
  }
  static std::vector<double> doubles(const Bytes& bytes, std::size_t from) {
    std::vector<double> out;
    for (std::size_t at = from; at + 8 <= bytes.size(); at += 9)
      out.push_back(WireReader(std::span(bytes).subspan(at)).real64());
    return out;
  }

  // z of the surface over a point; NaN: there is none.
  double elevation(double x, double y) {
    const Bytes reply = ask(WireWriter().word(23).flag(false).real(x).real(y), reply::kFloat);
    return reply.at(4) != 0 ? floats(reply, 0, 5)[0] : std::nan("");
  }

  Bytes image() { return ask(WireWriter().word(1), reply::kImage); }
  // Mean code of the middle pixels of a PPM reply, 0 to 255.
  double middle(const Bytes& reply) {
    double sum = 0;
    constexpr std::size_t kSide = 32;
    const std::size_t begin = reply.size() - 3 * kSide * kSide;
    for (std::size_t y = 14; y < 18; ++y)
      for (std::size_t x = 14; x < 18; ++x) sum += reply[begin + 3 * (kSide * y + x) + 1];
    return sum / 16;
  }

  TemporaryFolder folder_;
  DiagnosticLog log_;
  std::unique_ptr<Stage> stage_;
  std::unique_ptr<Session> session_;
  std::string note_;
};

TEST_F(SessionTest, PointsUnderPixelsAreThoseOfThePinhole) {
  const double half = std::tan(kFov * kDegree / 2) * 10;  // metres on the slab
  WireWriter request;
  request.word(5).word(4);
  for (const double number : {0.5, 0.5, 0.75, 0.5, 0.5, 0.25, 1.0, 1.0}) request.real(number);
  const Bytes reply = ask(std::move(request), reply::kPointArray);
  ASSERT_EQ(reply.size(), 4 + 4 * 13u);
  EXPECT_EQ(word_at(reply), 4u);
  const auto number = [&](int point, int k) { return floats(reply, 4 + 13 * point + 4 * k)[0]; };
  // (1, 1) is the upper right; up in the image is +y. Floats of the wire: 1.2e-7 of the value
  const double expected[4][3] = {{0, 0, 1}, {half / 2, 0, 1}, {0, -half / 2, 1}, {0, 0, 0}};
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(number(i, k), expected[i][k], 2e-7) << i << k;
  EXPECT_EQ(reply[4 + 12], 1);
  EXPECT_EQ(reply[4 + 3 * 13 + 12], 0);  // beside the slab
}

TEST_F(SessionTest, DirectionsAreInWorldAxes) {
  const Bytes reply = ask(WireWriter().word(6).real(0.1).real(0).real(-1), reply::kPoint);
  EXPECT_THAT(floats(reply, 0),
              testing::Pointwise(testing::DoubleNear(2e-7), std::vector<double>{1.0, 0.0, 1.0}));
}

TEST_F(SessionTest, ElevationsAndPatchesAreThoseOfThePlanes) {
  EXPECT_EQ(elevation(0, 0), 1);
  EXPECT_EQ(elevation(5, 0), 0.25);
  EXPECT_TRUE(std::isnan(elevation(3, 3)));
  EXPECT_EQ(floats(ask(WireWriter().word(2), reply::kFloat), 0, 5)[0], 10);
  // turned by 90 degrees, rows of rising x run along +y of the world
  const Bytes patch =
      ask(WireWriter().word(25).flag(true).real(5).real(0).word(3).word(1).real(0.2).real(kPi / 2),
          reply::kFloatArray);
  EXPECT_THAT(floats(patch, 4, 5), testing::ElementsAre(0.25, 0.25, 0.25));
  const Bytes wide =
      ask(WireWriter().word(25).flag(true).real(5).real(0).word(3).word(1).real(0.4).real(0),
          reply::kFloatArray);
  EXPECT_THAT(floats(wide, 4, 5), testing::ElementsAre(0, 0.25, 0));
  // heights above the level 10 m below the camera; the slab is that far away
  const Bytes dem =
      ask(WireWriter().word(31).word(1).flag(false).word(2).word(1).real(5).real(1).real(10),
          reply::kFloatArray);
  EXPECT_THAT(floats(dem, 4, 5), testing::ElementsAre(0, 0));
  EXPECT_EQ(word_at(dem), 2u);
}

// A slope of 1 in 4 under a craft: heights of its planes, by every request that asks for surfaces.
TEST_F(SessionTest, SurfacesOfTerrain) {
  constexpr int kPosts = 65;
  std::vector<float> heights;
  for (int row = 0; row < kPosts; ++row)
    for (int column = 0; column < kPosts; ++column)
      heights.push_back(0.25f * static_cast<float>(column) - 20);
  const std::string ground = folder_ / "ground.pan";
  ASSERT_TRUE(write_file(ground, support::plane_model(kPosts, heights)->bytes(), log_));
  StageOptions options;
  options.targets = {"craft=" + folder_.write("craft.pxn", kScene), "ground=" + ground};
  ASSERT_TRUE(workspace::read_setting(SettingId::sun, "0 0 1", options.defaults, log_));
  auto stage = Stage::open(options, log_, {});
  ASSERT_TRUE(stage) << to_text(log_);
  stage_ = *std::move(stage);
  session_ = std::make_unique<Session>(*stage_, std::make_shared<State>(stage_->initial()),
                                       SessionOptions{});
  // z = x / 4 - 12
  EXPECT_EQ(elevation(0, 0), 1);
  EXPECT_EQ(elevation(3, 3), -11.25);
  EXPECT_EQ(elevation(-20, 11), -17);
  EXPECT_TRUE(std::isnan(elevation(-33, 0)));
  const Bytes patch =
      ask(WireWriter().word(25).flag(false).real(10).real(10).word(3).word(2).real(2).real(0),
          reply::kFloatArray);
  EXPECT_THAT(floats(patch, 4, 5), testing::ElementsAre(-10, -9.5, -9, -10, -9.5, -9));
  ask(WireWriter().word(269).real64(20).real64(20).real64(3).real64(0).real64(1).real64(0).real64(
          0),
      reply::kOkay);
  EXPECT_EQ(floats(ask(WireWriter().word(2), reply::kFloat), 0, 5)[0], 10);
  const Bytes point = ask(WireWriter().word(6).real(0).real(0).real(-1), reply::kPoint);
  EXPECT_THAT(floats(point, 0), testing::ElementsAre(20, 20, -7));
}

// A damaged tile is a void of look-ups, and named once, with the request that came to it.
TEST_F(SessionTest, DamagedTilesAreNamed) {
  constexpr int kPosts = 600;  // 3 x 3 tiles
  const world::ModelPtr whole =
      support::plane_model(kPosts, std::vector<float>(kPosts * kPosts, 2.0f));
  std::vector<std::byte> bytes(whole->bytes().begin(), whole->bytes().end());
  const auto tiles = terrain::Tiles::of(whole, log_);
  ASSERT_TRUE(tiles && *tiles);
  bytes[128 + (**tiles).records()[4].offset + 77] ^= std::byte{1};
  const std::string ground = folder_ / "damaged.pan";
  ASSERT_TRUE(write_file(ground, bytes, log_));
  StageOptions options;
  options.targets = {"ground=" + ground};
  ASSERT_TRUE(workspace::read_setting(SettingId::sun, "0 0 1", options.defaults, log_));
  auto stage = Stage::open(options, log_, {});
  ASSERT_TRUE(stage) << to_text(log_);
  stage_ = *std::move(stage);
  DiagnosticLog told;
  SessionOptions session;
  session.log = &told;
  session_ =
      std::make_unique<Session>(*stage_, std::make_shared<State>(stage_->initial()), session);
  // the tile of columns and rows 256 to 512: x from -43.5 to 212.5, y from -212.5 to 43.5
  EXPECT_EQ(elevation(-100, 100), 2);
  EXPECT_EQ(note_, "");
  EXPECT_TRUE(std::isnan(elevation(50, -50)));
  EXPECT_THAT(note_, testing::HasSubstr("the tile of level 0, column 1, row 1 of chart 0"));
  EXPECT_TRUE(std::isnan(elevation(60, -60)));
  EXPECT_EQ(note_, "");
  ASSERT_EQ(told.entries().size(), 1u) << to_text(told);
  EXPECT_EQ(told.entries()[0].code, Code("W9615"));
  EXPECT_THAT(to_text(told), testing::HasSubstr("damaged.pan"));
}

TEST_F(SessionTest, ObjectsAndJointsMove) {
  const Bytes joints = ask(WireWriter().word(18).word(0), reply::kJointList);
  WireReader in(joints);
  ASSERT_EQ(in.word(), 2u);
  EXPECT_EQ(in.word(), 0u);
  const auto length = in.bytes(2);
  EXPECT_EQ(length[1], 6);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(in.bytes(6).data())), "slide");
  EXPECT_EQ(in.word(), 2u);  // prismatic
  const auto set = [&](std::uint32_t joint, double value) {
    WireWriter request;
    request.word(272).word(0).word(joint).word(9);
    for (int i = 0; i < 9; ++i) request.real64(i == 0 ? value : 7).flag(i == 0);
    ask(std::move(request), reply::kOkay);
  };
  set(0, 1);
  EXPECT_EQ(elevation(6, 0), 0.25);
  EXPECT_TRUE(std::isnan(elevation(5, 0)));
  set(1, kPi / 2);
  EXPECT_NEAR(elevation(9, 0), 0.05, 1e-7);
  EXPECT_EQ(doubles(ask(WireWriter().word(19).word(0).word(0), reply::kDoubleArray), 4)[0], 1);
  EXPECT_THAT(doubles(ask(WireWriter().word(19).word(0).word(7), reply::kDoubleArray), 4),
              testing::Each(0));
  set(9, 1);
  EXPECT_EQ(note_, "an unknown joint is ignored");
  WireWriter pose;
  pose.word(270).word(0);
  for (const double number : {0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0}) pose.real64(number);
  ask(std::move(pose), reply::kOkay);
  EXPECT_EQ(elevation(0, 0), 3);
  ask(WireWriter().word(277).word(0).word(0), reply::kOkay);
  EXPECT_TRUE(std::isnan(elevation(0, 0)));
}

TEST_F(SessionTest, FramesAreForwardUpRightOrigin) {
  const Bytes frame = ask(WireWriter().word(21).word(0).word(0), reply::kDoubleArray);
  EXPECT_THAT(doubles(frame, 4),
              testing::Pointwise(testing::DoubleNear(1e-15),
                                 std::vector<double>{0, 0, -1, 0, 1, 0, 1, 0, 0, 0, 0, 5}));
  const Bytes angles = ask(WireWriter().word(22).word(0).word(0), reply::kDoubleArray);
  EXPECT_THAT(doubles(angles, 4), testing::Pointwise(testing::DoubleNear(1e-15),
                                                     std::vector<double>{0, -kPi / 2, 0, 0, 0, 5}));
  // camera 2 is the first frame of the objects
  const Bytes camera = ask(WireWriter().word(29).word(2), reply::kCameraProperties);
  WireReader in(camera);
  EXPECT_EQ(in.word(), 80u);
  EXPECT_EQ(in.word(), 32u);
  EXPECT_EQ(in.word(), 32u);
  EXPECT_NEAR(in.real64(), kFov * kDegree, 1e-15);
  EXPECT_EQ(word_at(ask(WireWriter().word(29).word(3), reply::kCameraProperties)), 0u);
  EXPECT_EQ(word_at(ask(WireWriter().word(30).word(3), reply::kImage)), 0u);
  EXPECT_GT(word_at(ask(WireWriter().word(30).word(2), reply::kImage)), 0u);
}

// The same attitude by angles, radians, quaternion and frame draws the same image.
TEST_F(SessionTest, AllWaysOfAViewpointAgree) {
  const Bytes down = image();
  const auto angles = [](std::uint32_t number, double unit, bool single) {
    WireWriter out;
    out.word(number);
    for (const double each : {0.0, 0.0, kEye, 0.0, -90 * unit, 0.0})
      single ? out.real(each) : out.real64(each);
    return out;
  };
  EXPECT_EQ(ask(angles(11, 1, true), reply::kImage), down);
  EXPECT_EQ(ask(angles(16, 1, false), reply::kImage), down);
  EXPECT_EQ(ask(angles(26, kDegree, false), reply::kImage), down);
  const std::string header(down.begin() + 4, down.begin() + 17);
  EXPECT_EQ(header, "P6\n32 32\n255\n");
  EXPECT_EQ(word_at(down), 13 + 32 * 32 * 3u);
  // yaw swings to the left: from +y to -x
  ask(WireWriter().word(268).real64(3).real64(0).real64(0).real64(90).real64(0).real64(0),
      reply::kOkay);
  const Bytes point = ask(WireWriter().word(4).real(0.5).real(0.5), reply::kPoint);
  EXPECT_EQ(floats(point, 0)[0], 2);
}

TEST_F(SessionTest, LightFogAndSkyScaleTheImage) {
  // Lambert's plate of 0.8 below its Sun; half a code of rounding
  EXPECT_NEAR(middle(image()), 0.8 * 255, 0.51);
  ask(WireWriter().word(259).real(0.5).real(0.5).real(0.5), reply::kOkay);
  EXPECT_NEAR(middle(image()), 0.4 * 255, 0.51);
  ask(WireWriter().word(259).real(1).real(1).real(1), reply::kOkay);
  ask(WireWriter().word(285).word(2), reply::kOkay);
  ask(WireWriter().word(286).real64(0).real64(0.1).real64(0).real64(0), reply::kOkay);
  EXPECT_NEAR(middle(image()), 0.8 * std::exp(-1) * 255, 0.6);
  ask(WireWriter().word(260).word(6), reply::kOkay);
  EXPECT_NEAR(middle(image()), (0.8 * std::exp(-1) + 1 - std::exp(-1)) * 255, 0.6);
  ask(WireWriter().word(285).word(0), reply::kOkay);
  const Bytes white = image();
  EXPECT_EQ(white.back(), 255);  // the corner is sky
  ask(WireWriter().word(258).real(0.2).real(0.2).real(0.2), reply::kOkay);
  // twelve directions are even within 8 %
  EXPECT_NEAR(middle(image()), 0.8 * 1.2 * 255, 0.8 * 0.2 * 0.08 * 255 + 0.6);
}

TEST_F(SessionTest, PulsesScansAndSnapshotsMeasureThePlane) {
  const Bytes pulse =
      ask(WireWriter().word(13).real(0).real(0).real(3).real(0.3).real(0).real(-0.4),
          reply::kLidarPulse);
  EXPECT_THAT(floats(pulse, 0),
              testing::Pointwise(testing::DoubleNear(1e-6), std::vector<double>{2.5, 0.8}));
  const Bytes miss = ask(WireWriter().word(13).real(0).real(0).real(4).real(0).real(0).real(1),
                         reply::kLidarPulse);
  EXPECT_THAT(floats(miss, 0), testing::ElementsAre(0, 0));
  WireWriter lidar;
  lidar.word(265).real(8).real(4).word(4).word(2).real(0).real(0).word(1).word(1).word(0).word(3);
  for (int i = 0; i < 10; ++i) lidar.real(0);
  for (int i = 0; i < 12; ++i) lidar.word(0);
  ask(std::move(lidar), reply::kOkay);
  WireWriter scan;
  scan.word(32);
  for (const double number : {0.0, 0.0, kEye, 0.0, 1.0, 0.0, 0.0}) scan.real64(number);
  for (int i = 0; i < 18; ++i) scan.real64(0);
  const Bytes measured = ask(std::move(scan), reply::kLidarMeasurement);
  ASSERT_EQ(measured.size(), 33 * 4 + 2 * 8 * 8u);
  EXPECT_EQ(word_at(std::span(measured).subspan(32 * 4)), 128u);
  const auto echoes = floats(measured, 33 * 4);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 4; ++i) {
      const double azimuth = (i - 1.5) * 2, elevation = (0.5 - j) * 2;  // degrees
      const double cosine = std::cos(azimuth * kDegree) * std::cos(elevation * kDegree);
      EXPECT_NEAR(echoes[2 * (4 * j + i)], 10 / cosine, 2e-6);
      EXPECT_NEAR(echoes[2 * (4 * j + i) + 1], cosine, 1e-7);
      EXPECT_NEAR(echoes[16 + 2 * (4 * j + i)], azimuth, 1e-6);
      EXPECT_NEAR(echoes[16 + 2 * (4 * j + i) + 1], elevation, 1e-6);
    }
  WireWriter snapshot;
  snapshot.word(35).word(0);
  for (const double number : {0.0, 0.0, kEye, 0.0, 1.0, 0.0, 0.0}) snapshot.real64(number);
  const Bytes raw = ask(std::move(snapshot), reply::kRawImage);
  ASSERT_EQ(raw.size(), 20 + 32 * 32 * 12u);
  const std::size_t at = 20 + 12 * (16 * 32 + 16);
  const double offset = std::tan(kFov * kDegree / 2) / 32;
  const auto ieee = [&](std::size_t place) {
    return std::bit_cast<float>(word_at(std::span(raw).subspan(place)));
  };
  const double range = 10 * std::sqrt(1 + 2 * offset * offset);
  EXPECT_NEAR(ieee(at), range, 2e-6);
  EXPECT_NEAR(ieee(at + 4), 10 / range, 1e-6);
  EXPECT_EQ(ieee(at + 8), 1);
  EXPECT_EQ(ieee(28), 0);  // the corner is a miss
}

// A narrow beam down a plane, moving towards it: one speed and one range; half of it beside.
TEST_F(SessionTest, RadarBinsRangesAndSpeeds) {
  const auto radar = [&](std::uint32_t flags, double width) {
    WireWriter request;
    request.word(15).word(flags).word(1000).word(8).word(4);
    for (const double number :
         {2.0, 0.5, 0.0, 0.0, 0.0, 0.0, kEye, 0.0, 0.0, -3.0, 0.0, 1.0, 0.0, 0.0, width})
      request.real(number);
    for (int i = 0; i < 13; ++i) request.word(0);
    return ask(std::move(request), reply::kRadar);
  };
  const Bytes narrow = radar(1 | 8 | 16 | 128, 1);
  const auto head = floats(narrow, 4);
  EXPECT_NEAR(head[6], 10, 1e-5);  // least range
  EXPECT_NEAR(head[9], 3, 1e-5);   // largest speed
  EXPECT_EQ(word_at(std::span(narrow).subspan(4 * 11)), 8u);
  EXPECT_EQ(word_at(std::span(narrow).subspan(4 * 13)), 1000u);
  const std::size_t bins = 4 * 24;
  ASSERT_EQ(narrow.size(), bins + 4 * 8 * 4);
  // beyond the four bins of speed of 0.5 m/s from zero: nothing is counted there
  EXPECT_EQ(head[0], 0);
  EXPECT_EQ(head[1], 0);
  // the mean cosine of a cap of half a degree: (1 + cos)/2
  EXPECT_NEAR(floats(radar(1 | 8, 1), 4)[1], (1 + std::cos(0.5 * kDegree)) / 2, 1e-6);
  const auto fitted = floats(radar(1 | 8 | 256 | 512, 1), 4 * 24);
  EXPECT_EQ(std::accumulate(fitted.begin(), fitted.end(), 0.0), 1000);
  EXPECT_EQ(fitted[5] + fitted[8 + 5] + fitted[16 + 5] + fitted[24 + 5], 1000);  // 10 to 12 m
}

TEST_F(SessionTest, WrongNumbersAreErrorsAndChangeNothing) {
  const Bytes before = image();
  for (const double wrong : {std::nan(""), HUGE_VAL}) {
    WireWriter request;
    request.word(269);
    for (const double number : {0.0, wrong, 5.0, 1.0, 0.0, 0.0, 0.0}) request.real64(number);
    const Bytes reply = ask(std::move(request), reply::kError);
    EXPECT_EQ(word_at(reply), 1u);
  }
  WireWriter flat;
  flat.word(269);
  for (int i = 0; i < 7; ++i) flat.real64(0);
  ask(std::move(flat), reply::kError);
  ask(WireWriter().word(261).real(180), reply::kError);
  ask(WireWriter().word(25).flag(false).real(0).real(0).word(~0u).word(~0u).real(1).real(0),
      reply::kError);
  EXPECT_EQ(image(), before);
}

TEST_F(SessionTest, HoldBufferIsDisplayedOnce) {
  const Bytes held = image();
  ask(WireWriter().word(293).word(0).word(0), reply::kOkay);
  ask(WireWriter().word(268).real64(0).real64(-20).real64(0).real64(0).real64(0).real64(0),
      reply::kOkay);
  const Bytes other = image();
  EXPECT_NE(other, held);
  ask(WireWriter().word(294).word(0), reply::kOkay);
  EXPECT_EQ(image(), held);
  EXPECT_EQ(image(), other);
}

}  // namespace
}  // namespace panwright::server
