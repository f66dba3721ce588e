#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "image/arrays.h"
#include "image/png.h"
#include "labels/convert.h"
#include "labels/frame_files.h"
#include "pan/writer.h"
#include "tests/labels/samples.h"
#include "tests/support/shapes.h"
#include "tests/trace/trace_models.h"

namespace panwright::labels::formats_test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string messages(const DiagnosticLog& log) {
  std::string out;
  for (const Diagnostic& each : log.entries()) out += each.message + "\n";
  return out;
}

Conversion conversion_of(const SampleFolder& folder, std::vector<std::string> names) {
  Conversion out;
  out.folder = folder / "in";
  out.output = folder / "out";
  out.formats = std::move(names);
  return out;
}

// Folder with three frames in "in".
struct Frames : SampleFolder {
  Frames() {
    std::filesystem::create_directory(*this / "in");
    write_sample_frames(*this / "in", 3);
  }
};

// Converts and lets the peer of the format judge.
void judge(const std::string& format, const Conversion& conversion) {
  DiagnosticLog log;
  const auto converted = convert(conversion, log);
  ASSERT_TRUE(converted) << messages(log);
  EXPECT_EQ(converted->frames, 3u);
  EXPECT_FALSE(log.has_errors()) << messages(log);
  const PeerAnswer answer = peer("formats_peer.py", format + " " + conversion.folder.string() +
                                                        " " + conversion.output.string());
  if (answer.skipped) GTEST_SKIP() << answer.text;
  EXPECT_TRUE(answer.good) << answer.text;
}

TEST(Formats, Coco) {
  const Frames folder;
  judge("coco", conversion_of(folder, {"coco"}));
}

TEST(Formats, Speed) {
  const Frames folder;
  Conversion conversion = conversion_of(folder, {"speed"});
  conversion.targets = {"client"};
  judge("speed", conversion);
  std::filesystem::remove_all(folder / "out");
  conversion.formats = {"speedplus"};
  judge("speedplus", conversion);
}

TEST(Formats, Tables) {
  const Frames folder;
  Conversion conversion = conversion_of(folder, {"spark"});
  conversion.targets = {"client"};
  judge("spark", conversion);
  std::filesystem::remove_all(folder / "out");
  conversion.formats = {"urso"};
  judge("urso", conversion);
}

TEST(Formats, Yolo) {
  const Frames folder;
  for (const char* name : {"yolo", "yolo-pose", "yolo-seg"}) {
    std::filesystem::remove_all(folder / "out");
    judge(name, conversion_of(folder, {name}));
  }
}

TEST(Formats, Kitti) {
  const Frames folder;
  judge("kitti", conversion_of(folder, {"kitti"}));
}

// A box of 1 x 2 x 3 m, turned by 90 degrees about z, mirrored along its x and moved by (5, 0, 0).
TEST(Formats, Bop) {
  const Frames folder;
  pan::Contents contents = trace::testing_support::single(support::box({1, 2, 3}));
  contents.nodes.push_back(
      {"box", 0, {5, 0, 0}, Quat(std::sqrt(0.5), 0, 0, std::sqrt(0.5)), Vec3(-1, 1, 1)});
  contents.instances[0].node = 1;
  Conversion conversion = conversion_of(folder, {"bop"});
  conversion.targets = {"client", "servicer"};
  conversion.models = {{"client", trace::testing_support::model_of(contents)}};
  judge("bop", conversion);
}

TEST(Formats, BopChoosesAScaleForFarDepth) {
  const Frames folder;
  std::vector<float> depth(64 * 48, 10);
  depth[0] = 300.004f;
  depth[1] = std::numeric_limits<float>::infinity();
  const auto bytes = std::as_bytes(std::span(depth));
  const image::Array array{"depth", "<f4", {48, 64}, {bytes.begin(), bytes.end()}};
  DiagnosticLog log;
  ASSERT_TRUE(image::write_arrays(folder / "in/000001.npz", {&array, 1}, log));
  // an image of one channel has another folder
  image::PngOptions grey;
  grey.channels = 1;
  std::ofstream(folder / "in/000002.png", std::ios::binary)
      << image::png_file(64, 48, std::vector<std::uint8_t>(64 * 48, 90), grey);
  ASSERT_TRUE(convert(conversion_of(folder, {"bop"}), log)) << messages(log);
  EXPECT_THAT(messages(log), HasSubstr("bop: frame 000001: depth reaches beyond 65.535 m: "
                                       "depth_scale is 10, depth is rounded to 10 mm"));
  const auto cameras =
      nlohmann::json::parse(file_bytes(folder / "out/train/000000/scene_camera.json"));
  EXPECT_EQ(cameras["0"]["depth_scale"], 1);
  EXPECT_EQ(cameras["1"]["depth_scale"], 10);
  EXPECT_EQ(cameras["2"]["depth_scale"], 1);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/train/000000/rgb/000001.png"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/train/000000/gray/000002.png"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/train/000000/rgb/000002.png"));
}

TEST(Formats, LossesAreTold) {
  const Frames folder;
  std::filesystem::remove(folder / "in/000001.npz");
  std::filesystem::remove(folder / "in/000001.png");
  DiagnosticLog log;
  ASSERT_TRUE(convert(conversion_of(folder, {"bop"}), log));
  EXPECT_THAT(messages(log), HasSubstr("frame 000001: it has no depth"));
  EXPECT_THAT(messages(log), HasSubstr("frame 000001: it has no PNG image"));
  EXPECT_THAT(messages(log), HasSubstr("frame 000000 and 2 more: parts have no models"));
  EXPECT_THAT(messages(log), HasSubstr("'servicer' has no model"));
}

// A frame with two values of a kind counts once.
TEST(Formats, LossesCountFrames) {
  const Frames folder;
  FrameLabels frame = sample_frame(1);
  frame.things[2].label = "boom";
  DiagnosticLog log;
  ASSERT_TRUE(write_frame(folder / "in", frame, log));
  for (const char* number : {"0", "2"})
    std::filesystem::remove(folder / ("in/00000" + std::string(number) + ".labels.json"));
  ASSERT_TRUE(convert(conversion_of(folder, {"bop"}), log)) << messages(log);
  EXPECT_THAT(messages(log), HasSubstr("bop: frame 000001: parts have no models"));
}

TEST(Formats, MotionBeyondKitti) {
  const Frames folder;
  FrameLabels frame = sample_frame(1);
  const std::size_t at = 2 * (22 * 64 + 38);
  ASSERT_FALSE(std::isnan(frame.forward->motion[at]));
  frame.forward->motion[at] = 512;
  DiagnosticLog log;
  ASSERT_TRUE(write_frame(folder / "in", frame, log));
  ASSERT_TRUE(convert(conversion_of(folder, {"kitti"}), log));
  EXPECT_THAT(messages(log), HasSubstr("frame 000001: motion of 512 pixels"));
}

TEST(Formats, KittiPairsFramesThatFollowEachOther) {
  const Frames folder;
  std::filesystem::remove(folder / "in/000001.labels.json");
  DiagnosticLog log;
  ASSERT_TRUE(convert(conversion_of(folder, {"kitti"}), log));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/image_2/000000_10.png"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/image_2/000000_11.png"));
  EXPECT_THAT(messages(log), HasSubstr("frame 000002: it does not follow frame 0"));
}

TEST(Formats, SeveralTargetsAreNoSpeed) {
  const Frames folder;
  for (const char* name : {"speed", "speedplus", "spark", "urso"}) {
    std::filesystem::remove_all(folder / "out");
    DiagnosticLog log;
    EXPECT_FALSE(convert(conversion_of(folder, {name}), log));
    EXPECT_TRUE(log.contains(Code("E9003"))) << name;
  }
}

TEST(Formats, WrongRequests) {
  const Frames folder;
  std::filesystem::create_directory(folder / "empty");
  Conversion conversion = conversion_of(folder, {"cocoa"});
  DiagnosticLog log;
  EXPECT_FALSE(convert(conversion, log));
  EXPECT_TRUE(log.contains(Code("E0201")));
  EXPECT_THAT(log.entries()[0].hint, HasSubstr("coco"));
  conversion.formats = {"coco"};
  conversion.targets = {"clent"};
  DiagnosticLog misspelt;
  EXPECT_FALSE(convert(conversion, misspelt));
  EXPECT_TRUE(misspelt.contains(Code("E9003")));
  EXPECT_THAT(misspelt.entries()[0].hint, HasSubstr("client"));
  conversion.targets.clear();
  DiagnosticLog twice;
  std::ofstream(folder / "out/before.txt") << "x";
  EXPECT_FALSE(convert(conversion, twice));
  EXPECT_THAT(messages(twice), HasSubstr("the folder to write has files already"));
  std::filesystem::remove_all(folder / "out");
  conversion.folder = folder / "empty";
  DiagnosticLog none;
  EXPECT_FALSE(convert(conversion, none));
  EXPECT_TRUE(none.contains(Code("E9003")));
  conversion.folder = folder / "absent";
  DiagnosticLog absent;
  EXPECT_FALSE(convert(conversion, absent));
  EXPECT_TRUE(absent.contains(Code("E0101")));
}

// A frame that cannot be read is an error; the others are written.
TEST(Formats, ATornFrameIsLeftOut) {
  const Frames folder;
  std::ofstream(folder / "in/000001.labels.json") << "{";
  DiagnosticLog log;
  const auto converted = convert(conversion_of(folder, {"coco"}), log);
  ASSERT_TRUE(converted);
  EXPECT_EQ(converted->frames, 2u);
  EXPECT_TRUE(log.contains(Code("E9001")));
}

TEST(Formats, TheSameFramesMakeTheSameBytes) {
  const Frames folder;
  Conversion conversion = conversion_of(folder, {});
  for (const FormatInfo& info : formats()) conversion.formats.emplace_back(info.name);
  conversion.targets = {"client"};
  std::map<std::string, std::string> first;
  for (int round = 0; round < 2; ++round) {
    DiagnosticLog log;
    ASSERT_TRUE(convert(conversion, log)) << messages(log);
    std::size_t files = 0;
    for (const auto& each : std::filesystem::recursive_directory_iterator(conversion.output)) {
      if (!each.is_regular_file()) continue;
      const std::string name = each.path().lexically_relative(conversion.output).string();
      const std::string bytes = file_bytes(each.path());
      EXPECT_EQ(first.try_emplace(name, bytes).first->second, bytes) << name;
      ++files;
    }
    EXPECT_GT(files, 50u);
    std::filesystem::remove_all(conversion.output);
  }
}

// Identities as Psyop's utilities give them, of targets with these names; coverage and order as in
// the masks.
TEST(Formats, Cryptomatte) {
  const SampleFolder folder;
  std::filesystem::create_directory(folder / "in");
  FrameLabels frame = sample_frame(0);
  const char* names[] = {"torus", "bunny", "равнина"};
  for (std::size_t k = 0; k < 3; ++k) {
    frame.things[k].target = names[k];
    frame.things[k].label.clear();
  }
  DiagnosticLog log;
  ASSERT_TRUE(write_frame(folder / "in", frame, log));
  ASSERT_TRUE(convert(conversion_of(folder, {"cryptomatte"}), log)) << messages(log);
  Imf::InputFile file((folder / "out/000000.cryptomatte.exr").c_str());
  const auto text = [&](const char* name) {
    const auto* value = file.header().findTypedAttribute<Imf::StringAttribute>(name);
    return value == nullptr ? std::string() : value->value();
  };
  const std::string key = "cryptomatte/3ae39a5/";  // digits of the name's hash, 3ae39a58
  EXPECT_EQ(text((key + "name").c_str()), "CryptoObject");
  EXPECT_EQ(text((key + "hash").c_str()), "MurmurHash3_32");
  EXPECT_EQ(text((key + "conversion").c_str()), "uint32_to_float32");
  const auto manifest = nlohmann::json::parse(text((key + "manifest").c_str()));
  EXPECT_EQ(manifest["torus"], "f19c73fd");
  EXPECT_EQ(manifest["bunny"], "13851a76");
  EXPECT_EQ(manifest["равнина"], "9623511e");
  std::vector<std::vector<float>> channels(12, std::vector<float>(64 * 48));
  Imf::FrameBuffer buffer;
  for (std::size_t k = 0; k < 12; ++k)
    buffer.insert("CryptoObject0" + std::to_string(k / 4) + "." + "rgba"[k % 4],
                  Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(channels[k].data()), 4, 4 * 64));
  file.setFrameBuffer(buffer);
  file.readPixels(0, 47);
  const std::uint32_t ids[] = {0xf19c73fd, 0x13851a76, 0x9623511e};
  for (std::size_t at = 0; at < 64 * 48; ++at) {
    std::map<std::uint32_t, float> expected, found;
    for (std::size_t k = 0; k < 3; ++k) {
      const Mask& mask = frame.things[k].visible;
      const std::size_t x = at % 64 - mask.left, y = at / 64 - mask.top;
      if (x < mask.width && y < mask.height && mask.coverage[y * mask.width + x] > 0)
        expected[ids[k]] = static_cast<float>(mask.coverage[y * mask.width + x]) / 255;
    }
    float before = 2;
    for (std::size_t k = 0; k < 12; k += 2) {
      if (channels[k + 1][at] > 0)
        found[std::bit_cast<std::uint32_t>(channels[k][at])] = channels[k + 1][at];
      EXPECT_LE(channels[k + 1][at], before);
      before = channels[k + 1][at];
    }
    ASSERT_EQ(found, expected) << at;
  }
}

// Hashes with an exponent of 0 or 255, 805e3ffb and ffcd29e5: bit 23 is flipped.
TEST(Formats, CryptomatteIdentitiesAreNormalFloats) {
  const SampleFolder folder;
  std::filesystem::create_directory(folder / "in");
  FrameLabels frame = sample_frame(0);
  frame.things[0].target = frame.things[1].target = "t81";
  frame.things[2].target = "t219";
  DiagnosticLog log;
  ASSERT_TRUE(write_frame(folder / "in", frame, log));
  ASSERT_TRUE(convert(conversion_of(folder, {"cryptomatte"}), log)) << messages(log);
  const Imf::InputFile file((folder / "out/000000.cryptomatte.exr").c_str());
  const auto* manifest =
      file.header().findTypedAttribute<Imf::StringAttribute>("cryptomatte/3ae39a5/manifest");
  ASSERT_NE(manifest, nullptr);
  EXPECT_EQ(manifest->value(), R"({"t81":"80de3ffb","t219":"ff4d29e5"})");
  const auto* parts =
      file.header().findTypedAttribute<Imf::StringAttribute>("cryptomatte/3201c4f/name");
  ASSERT_NE(parts, nullptr);
  EXPECT_EQ(parts->value(), "CryptoPart");
}

}  // namespace
}  // namespace panwright::labels::formats_test
