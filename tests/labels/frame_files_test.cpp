#include "labels/frame_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "image/arrays.h"
#include "sensor/lens.h"
#include "tests/labels/samples.h"

namespace panwright::labels::frame_files_test {
namespace {

using testing::HasSubstr;

std::string messages(const DiagnosticLog& log) {
  std::string out;
  for (const Diagnostic& each : log.entries()) out += each.message + "\n";
  return out;
}

void put(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(FrameFiles, ReadBackToTheSameBits) {
  const SampleFolder folder;
  for (int number = 0; number < 4; ++number) {
    FrameLabels frame = sample_frame(number);
    if (number == 1)
      frame.camera.distortion =
          std::make_shared<sensor::DistortionMap>(sensor::Brown{{-0.1, 1.0 / 3, 1e-3, -1e-4, 0.1}});
    if (number == 2) frame.camera.projection = world::Projection::orthographic;
    DiagnosticLog log;
    ASSERT_TRUE(write_frame(folder.path(), frame, log)) << messages(log);
    const auto read = read_frame(folder / (frame.name + ".labels.json"), log);
    ASSERT_TRUE(read) << messages(log);
    EXPECT_EQ(difference(*read, frame), "");
  }
}

TEST(FrameFiles, AFrameWithoutThingsHasOneFile) {
  const SampleFolder folder;
  FrameLabels frame = sample_frame(0);
  frame.things.clear();
  frame.forward.reset();
  DiagnosticLog log;
  ASSERT_TRUE(write_frame(folder.path(), frame, log));
  const auto read = read_frame(folder / "000000.labels.json", log);
  ASSERT_TRUE(read);
  EXPECT_EQ(difference(*read, frame), "");
  EXPECT_FALSE(std::filesystem::exists(folder / "000000.masks.npz"));
}

// Of a keypoint close to the camera's plane, and a box of it.
TEST(FrameFiles, HugeNumbers) {
  const SampleFolder folder;
  FrameLabels frame = sample_frame(0);
  frame.things[0].keypoints[0].pixel = Vec2(1e280, -1e17);
  frame.things[0].amodal_box = Box{-1e290, 0, 1e20, 1};
  DiagnosticLog log;
  ASSERT_TRUE(write_frame(folder.path(), frame, log));
  const auto read = read_frame(folder / "000000.labels.json", log);
  ASSERT_TRUE(read) << messages(log);
  EXPECT_EQ(difference(*read, frame), "");
}

// A map without distortion is none.
TEST(FrameFiles, PinholesHaveNoDistortion) {
  const SampleFolder folder;
  FrameLabels frame = sample_frame(0);
  frame.camera.distortion = std::make_shared<sensor::DistortionMap>(sensor::Pinhole());
  DiagnosticLog log;
  ASSERT_TRUE(write_frame(folder.path(), frame, log));
  const auto read = read_frame(folder / "000000.labels.json", log);
  ASSERT_TRUE(read) << messages(log);
  EXPECT_EQ(read->camera.distortion, nullptr);
}

TEST(FrameFiles, TheSameLabelsMakeTheSameBytes) {
  const SampleFolder folder;
  DiagnosticLog log;
  for (const char* name : {"a", "b"}) {
    std::filesystem::create_directory(folder / name);
    ASSERT_TRUE(write_frame(folder / name, sample_frame(1), log));
  }
  for (const char* name :
       {"000001.labels.json", "000001.masks.npz", "000001.forward.flo", "000001.backward.flo"}) {
    const std::string bytes = file_bytes(folder / "a" / name);
    EXPECT_FALSE(bytes.empty());
    EXPECT_EQ(bytes, file_bytes(folder / "b" / name)) << name;
  }
}

// Header of Middlebury: PIEH, width, height, then u and v from the upper left pixel on.
TEST(FrameFiles, FlowIsThatOfMiddlebury) {
  const SampleFolder folder;
  FrameLabels frame = sample_frame(0);
  frame.forward->motion[2] = 1.5f;
  frame.forward->motion[3] = -2.0f;
  DiagnosticLog log;
  ASSERT_TRUE(write_frame(folder.path(), frame, log));
  const std::string bytes = file_bytes(folder / "000000.forward.flo");
  ASSERT_EQ(bytes.size(), 12u + 64 * 48 * 8);
  EXPECT_EQ(bytes.substr(0, 12), std::string("PIEH\x40\0\0\0\x30\0\0\0", 12));
  float magic = 0, values[4];
  std::memcpy(&magic, bytes.data(), 4);
  std::memcpy(values, bytes.data() + 12, 16);
  EXPECT_EQ(magic, 202021.25f);
  EXPECT_GT(values[0], 1e9f);
  EXPECT_GT(values[1], 1e9f);
  EXPECT_EQ(values[2], 1.5f);
  EXPECT_EQ(values[3], -2.0f);
}

TEST(FrameFiles, NumpyReadsThemAndTheSchemaHolds) {
  const SampleFolder folder;
  DiagnosticLog log;
  for (int number = 0; number < 3; ++number)
    ASSERT_TRUE(write_frame(folder.path(), sample_frame(number), log));
  const PeerAnswer answer = peer("own_files_peer.py", folder.path().string());
  if (answer.skipped) GTEST_SKIP() << answer.text;
  EXPECT_TRUE(answer.good) << answer.text;
}

// Every member in turn is absent, or of another type: an error each, of that member.
TEST(FrameFiles, WrongMembersAreNamed) {
  const SampleFolder folder;
  DiagnosticLog first;
  ASSERT_TRUE(write_frame(folder.path(), sample_frame(1), first));
  const auto file = folder / "000001.labels.json";
  const auto whole = nlohmann::json::parse(file_bytes(file));
  const auto flat = whole.flatten();
  std::size_t tried = 0;
  for (const auto& [pointer, value] : flat.items()) {
    if (pointer == "/masks" || pointer == "/forward" || pointer == "/backward" ||
        pointer.find("visible_fraction") != std::string::npos)
      continue;
    auto wrong = whole;
    wrong[nlohmann::json::json_pointer(pointer)] = nlohmann::json::object();
    put(file, wrong.dump());
    DiagnosticLog log;
    EXPECT_FALSE(read_frame(file, log)) << pointer;
    EXPECT_TRUE(log.contains(Code("E9001"))) << pointer;
    ++tried;
  }
  EXPECT_GT(tried, 100u);
}

TEST(FrameFiles, HostileTexts) {
  const SampleFolder folder;
  const auto file = folder / "f.labels.json";
  DiagnosticLog written;
  FrameLabels frame = sample_frame(0);
  frame.name = "f";
  ASSERT_TRUE(write_frame(folder.path(), frame, written));
  const std::string good = file_bytes(file);
  const auto with = [&](const std::string& from, const std::string& to) {
    const std::size_t at = good.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return good.substr(0, at) + to + good.substr(at + from.size());
  };
  for (const std::string& text :
       {std::string(), std::string("[]"), good.substr(0, good.size() / 2),
        std::string(4'000'000, '['), std::string("{\"a\":1e999}"),
        with("\"000000.png\"", "\"../../x.png\""), with("\"000000.png\"", "\"/etc/x.png\""),
        with("\"name\":\"f\"", "\"name\":\"g\""), with("\"width\":64", "\"width\":999999"),
        with("\"id\":2", "\"id\":1"), with("\"id\":2", "\"id\":-2"),
        with("\"amodal_pixels\":", "\"amodal_pixels\":-"), with("frame_labels/1", "frame_labels/2"),
        with("\"visible\":{\"left\":", "\"visible\":{\"left\":64.5,\"x\":"),
        with("\"focal\":[80", "\"focal\":[-80")}) {
    put(file, text);
    DiagnosticLog log;
    EXPECT_FALSE(read_frame(file, log)) << text.substr(0, 80);
    EXPECT_TRUE(log.contains(Code("E9001"))) << text.substr(0, 80);
  }
}

// A bit of every third byte of the masks' archive flipped in turn: read to the same masks, or
// refused.
TEST(FrameFiles, DamagedArchivesAreRefused) {
  const SampleFolder folder;
  const FrameLabels frame = sample_frame(0);
  DiagnosticLog written;
  ASSERT_TRUE(write_frame(folder.path(), frame, written));
  const auto archive = folder / "000000.masks.npz";
  const std::string good = file_bytes(archive);
  std::size_t refused = 0;
  for (std::size_t at = 0; at < good.size(); at += 3) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ (1 << at % 8));
    put(archive, bad);
    DiagnosticLog log;
    const auto read = read_frame(folder / "000000.labels.json", log);
    if (read)
      EXPECT_EQ(difference(*read, frame), "") << at;
    else
      ++refused;
  }
  EXPECT_GT(refused, good.size() / 6);
  for (std::size_t size = 0; size < good.size(); size += 7) {
    put(archive, good.substr(0, size));
    DiagnosticLog log;
    EXPECT_FALSE(read_frame(folder / "000000.labels.json", log)) << size;
  }
}

TEST(FrameFiles, FlowOfAnotherSizeIsRefused) {
  const SampleFolder folder;
  DiagnosticLog log;
  ASSERT_TRUE(write_frame(folder.path(), sample_frame(0), log));
  const auto file = folder / "000000.forward.flo";
  put(file, file_bytes(file) + "x");
  EXPECT_FALSE(read_frame(folder / "000000.labels.json", log));
  EXPECT_TRUE(log.contains(Code("E9001")));
  DiagnosticLog without;
  EXPECT_TRUE(read_frame(folder / "000000.labels.json", without, {true, false}));
}

}  // namespace
}  // namespace panwright::labels::frame_files_test
