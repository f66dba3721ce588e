#include "image/image.h"

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>

#include "base/file.h"
#include "base/math.h"
#include "image/internal/zip.h"
#include "tests/image/image_folder.h"
#include "tests/support/paths.h"

namespace panwright::image::image_test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

class ImageFiles : public testing_support::ImageFolder {};

// every value differs from every other of its layer
Image numbered(std::uint32_t width, std::uint32_t height, bool ground_truth) {
  Image image;
  image.width = width;
  image.height = height;
  image.unit = "1/sr";
  const std::size_t n = image.pixels();
  for (std::size_t i = 0; i < 3 * n; ++i) image.radiance.push_back(static_cast<float>(i) / 64);
  for (std::size_t i = 0; i < n; ++i) image.coverage.push_back(i % 2 ? 1.0f : 0.5f);
  if (!ground_truth) return image;
  for (std::size_t i = 0; i < n; ++i) {
    image.depth.push_back(i ? 10 + static_cast<float>(i) : kInfinity);
    image.range.push_back(i ? 11 + static_cast<float>(i) : kInfinity);
    for (int k = 0; k < 3; ++k) image.normal.push_back(static_cast<float>(3 * i) + k);
    image.target_id.push_back(static_cast<std::uint32_t>(i % 3));
    image.node_id.push_back(static_cast<std::uint32_t>(4000000000u + i));
    image.material_id.push_back(static_cast<std::uint32_t>(i));
  }
  return image;
}

std::string output_of(const std::string& command) {
  std::string text;
  if (FILE* pipe = popen(command.c_str(), "r")) {
    std::array<char, 4096> buffer{};
    while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe))
      text.append(buffer.data(), n);
    if (pclose(pipe) != 0) text += "(failed)";
  }
  return text;
}

TEST(ImageFormats, ByExtension) {
  EXPECT_EQ(image_format("a/b.png"), ImageFormat::png);
  EXPECT_EQ(image_format("b.EXR"), ImageFormat::exr);
  EXPECT_EQ(image_format("b.x.npy"), ImageFormat::npy);
  EXPECT_EQ(image_format("b.Npz"), ImageFormat::npz);
  EXPECT_EQ(image_format("b.bmp"), std::nullopt);
  EXPECT_EQ(image_format("png"), std::nullopt);
  EXPECT_FALSE(stores_ground_truth(ImageFormat::png));
  EXPECT_FALSE(stores_ground_truth(ImageFormat::npy));
  EXPECT_TRUE(stores_ground_truth(ImageFormat::exr));
  EXPECT_TRUE(stores_ground_truth(ImageFormat::npz));
}

TEST_F(ImageFiles, OtherExtensionsAreRefused) {
  DiagnosticLog log;
  EXPECT_FALSE(write_image(path("a.jpeg"), numbered(2, 2, false), 0, log));
  ASSERT_TRUE(log.contains(Code("E0202")));
  EXPECT_THAT(log.entries()[0].message, testing::HasSubstr(".jpeg"));
  EXPECT_FALSE(std::filesystem::exists(path("a.jpeg")));
}

TEST_F(ImageFiles, AFolderThatIsNotThere) {
  DiagnosticLog log;
  EXPECT_FALSE(write_image(path("no/such/a.npy"), numbered(2, 2, false), 0, log));
  EXPECT_TRUE(log.contains(Code("E0103")));
}

// Gold of 12 brightnesses: hue by its definition, (g - b) / (r - b), to the rounding of the codes.
TEST_F(ImageFiles, PhotographsKeepHue) {
  constexpr std::uint32_t kCount = 12;
  Image image = numbered(kCount, 2, false);
  const Vec3 gold(1, 0.6, 0.1);
  for (std::uint32_t i = 0; i < kCount; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = gold[static_cast<int>(k)] * std::exp2(i / 2.0 - 3) / kPi;
      image.radiance[3 * i + k] = static_cast<float>(value);
      image.radiance[3 * (kCount + i) + k] = i < 6 ? kInfinity : 0.0f;
    }
  DiagnosticLog log;
  ASSERT_TRUE(write_image(path("a.png"), image, {0, true}, log));
  png_image head;
  std::memset(&head, 0, sizeof head);
  head.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&head, path("a.png").c_str()));
  std::array<std::uint8_t, std::size_t{3} * kCount * 2> codes{};
  ASSERT_TRUE(png_image_finish_read(&head, nullptr, codes.data(), 0, nullptr));
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::uint8_t* code = codes.data() + 3 * i;
    if (i <= 4) {  // up to half of white: linear
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(code[k], srgb_code(kPi * image.radiance[3 * i + k])) << i;
    }
    const double r = srgb_decoded(code[0]), g = srgb_decoded(code[1]), b = srgb_decoded(code[2]);
    // half a code of the brightest is 0.0045; measured: at most 0.9 of this
    EXPECT_NEAR((g - b) / (r - b), 0.5 / 0.9, 0.01 / (r - b)) << i;
    if (i == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_GT(code[k], (code - 3)[k]) << i;
  }
  EXPECT_LT(codes[3 * (kCount - 1)], 255);  // 6 times white is not clipped
  EXPECT_EQ(codes[3 * kCount], 255);
  EXPECT_EQ(codes[3 * kCount + 2], 255);
  EXPECT_EQ(codes[codes.size() - 1], 0);
}

TEST_F(ImageFiles, PngIsWhiteForAWhitePlate) {
  Image image = numbered(3, 2, false);
  const double white = 1 / kPi;
  const std::array<double, 6> grey{white, white / 2, white * 2, 0, -1, white / 4};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      image.radiance[3 * i + k] = static_cast<float>(grey[i] * (k == 2 ? 0.5 : 1.0));
  DiagnosticLog log;
  ASSERT_TRUE(write_image(path("a.png"), image, 0, log));
  ASSERT_TRUE(write_image(path("b.png"), image, 1, log));
  for (const char* name : {"a.png", "b.png"}) {
    const double gain = name[0] == 'a' ? 1 : 2;
    png_image head;
    std::memset(&head, 0, sizeof head);
    head.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_file(&head, path(name).c_str()));
    EXPECT_EQ(head.format, static_cast<unsigned>(PNG_FORMAT_RGB));
    ASSERT_EQ(head.width, 3u);
    ASSERT_EQ(head.height, 2u);
    std::array<std::uint8_t, 18> codes{};
    ASSERT_TRUE(png_image_finish_read(&head, nullptr, codes.data(), 0, nullptr));
    for (std::size_t i = 0; i < 18; ++i)
      EXPECT_EQ(codes[i], srgb_code(gain * kPi * image.radiance[i])) << name << i;
    EXPECT_EQ(codes[0], 255);  // white Lambert plate at normal Sun
  }
}

TEST_F(ImageFiles, NpyIsRadianceRowByRow) {
  const Image image = numbered(5, 3, true);
  DiagnosticLog log;
  ASSERT_TRUE(write_image(path("a.npy"), image, 0, log));
  const std::string data = bytes(path("a.npy"));
  ASSERT_EQ(data.size(), 128 + 4 * image.radiance.size());
  EXPECT_THAT(data.substr(0, 128),
              testing::HasSubstr("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 5, 3), }"));
  EXPECT_EQ(data[127], '\n');
  EXPECT_EQ(std::memcmp(data.data() + 128, image.radiance.data(), data.size() - 128), 0);
}

TEST_F(ImageFiles, NpzHoldsEveryLayer) {
  const Image image = numbered(5, 3, true);
  DiagnosticLog log;
  ASSERT_TRUE(write_image(path("a.npz"), image, 0, log));
  const std::string listing =
      output_of(std::string(PANWRIGHT_PYTHON) + " " +
                PANWRIGHT_SOURCE_DIR "/tests/image/read_npz.py " + path("a.npz").string());
  EXPECT_EQ(listing,
            "radiance.npy 3x5x3 <f4 15.46875\n"  // (0+…+44)/64
            "coverage.npy 3x5 <f4 11.0\n"        // 8·0.5 + 7·1
            "depth.npy 3x5 <f4 inf\n"            //
            "range.npy 3x5 <f4 inf\n"            //
            "normal.npy 3x5x3 <f4 990.0\n"       // 0+…+44
            "target_id.npy 3x5 <u4 15.0\n"
            "node_id.npy 3x5 <u4 60000000105.0\n"
            "material_id.npy 3x5 <u4 105.0\n");
}

TEST_F(ImageFiles, NpzWithoutGroundTruthHoldsTwoLayers) {
  DiagnosticLog log;
  ASSERT_TRUE(write_image(path("a.npz"), numbered(1, 1, false), 0, log));
  EXPECT_EQ(output_of(std::string(PANWRIGHT_PYTHON) + " " +
                      PANWRIGHT_SOURCE_DIR "/tests/image/read_npz.py " + path("a.npz").string()),
            "radiance.npy 1x1x3 <f4 0.046875\ncoverage.npy 1x1 <f4 0.5\n");
}

TEST_F(ImageFiles, LayersAreChosenAndCompressed) {
  const Image image = numbered(300, 200, true);
  FileOptions options;
  options.layers = 1u << static_cast<unsigned>(FileLayer::node_id) |
                   1u << static_cast<unsigned>(FileLayer::coverage);
  DiagnosticLog log;
  const auto listing = [&] {
    return output_of(std::string(PANWRIGHT_PYTHON) + " " +
                     PANWRIGHT_SOURCE_DIR "/tests/image/read_npz.py " + path("a.npz").string());
  };
  ASSERT_TRUE(write_image(path("a.npz"), image, 0, log, nullptr, options));
  const std::string stored = listing();
  EXPECT_THAT(stored, testing::MatchesRegex("coverage.npy 200x300 <f4 [0-9.]*\nnode_id.npy .*\n"));
  const std::size_t bytes_stored = bytes(path("a.npz")).size();
  options.compress = true;
  ASSERT_TRUE(write_image(path("a.npz"), image, 0, log, nullptr, options));
  EXPECT_EQ(listing(), stored);
  EXPECT_LT(bytes(path("a.npz")).size(), bytes_stored / 2);
  ASSERT_TRUE(write_image(path("a.exr"), image, 0, log, nullptr, options));
  const Imf::InputFile input(path("a.exr").c_str());
  std::string names;
  const auto& channels = input.header().channels();
  for (auto it = channels.begin(); it != channels.end(); ++it)
    names += std::string(it.name()) + " ";
  EXPECT_EQ(names, "A id.node ");
  EXPECT_TRUE(stores_ground_truth(ImageFormat::exr, options));
  options.layers = 1u << static_cast<unsigned>(FileLayer::radiance);
  EXPECT_FALSE(stores_ground_truth(ImageFormat::npz, options));
}

// The records for archives past 4 GiB, made small by lowering the limit from which they are used.
TEST_F(ImageFiles, Zip64IsReadByOthers) {
  const std::string script =
      "import zipfile,sys; z=zipfile.ZipFile(sys.argv[1]); assert z.testzip() is None; "
      "print([(i.filename, z.read(i).decode(), i.header_offset) for i in z.infolist()])";
  for (const std::uint64_t limit : {std::uint64_t{0}, std::uint64_t{4}, std::uint64_t{40}}) {
    DiagnosticLog log;
    auto file = AtomicFile::create(path("z.zip"), log);
    ASSERT_TRUE(file);
    ZipWriter zip(*file, limit);
    ASSERT_TRUE(zip.add("one", as_bytes("ab"), as_bytes("c"), log));
    ASSERT_TRUE(zip.add("two", as_bytes("defgh"), {}, log));
    ASSERT_TRUE(zip.finish(log));
    ASSERT_TRUE(file->commit(log));
    auto other = AtomicFile::create(path("d.zip"), log);
    ASSERT_TRUE(other);
    ZipWriter deflated(*other, limit);
    ASSERT_TRUE(
        deflated.add("one", as_bytes("ab"), as_bytes(std::string(3000000, 'c')), log, true));
    ASSERT_TRUE(deflated.add("none", {}, {}, log, true));
    ASSERT_TRUE(deflated.add("head", as_bytes("defgh"), {}, log, true));
    ASSERT_TRUE(deflated.finish(log));
    ASSERT_TRUE(other->commit(log));
    EXPECT_LT(bytes(path("d.zip")).size(), 20000u);
    EXPECT_EQ(output_of(std::string(PANWRIGHT_PYTHON) +
                        " -c \"import zipfile,sys; z=zipfile.ZipFile(sys.argv[1]); assert "
                        "z.testzip() is None; print([(len(z.read(i)), z.read(i)[:3]) for i in "
                        "z.infolist()])\" " +
                        path("d.zip").string()),
              "[(3000002, b'abc'), (0, b''), (5, b'def')]\n");
    const int second = limit == 0 ? 30 + 3 + 20 + 3 : 30 + 3 + 3;
    EXPECT_EQ(
        output_of(std::string(PANWRIGHT_PYTHON) + " -c '" + script + "' " + path("z.zip").string()),
        "[('one', 'abc', 0), ('two', 'defgh', " + std::to_string(second) + ")]\n");
  }
}

TEST_F(ImageFiles, ExrHoldsEveryLayerBitForBit) {
  Image image = numbered(7, 5, true);
  image.metadata = {{"camera", "0 0 1"}};
  DiagnosticLog log;
  ASSERT_TRUE(write_image(path("a.exr"), image, 0, log));

  Imf::InputFile input(path("a.exr").c_str());
  const Imf::Header& header = input.header();
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("radianceUnit").value(), "1/sr");
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("camera").value(), "0 0 1");
  std::size_t channels = 0;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) ++channels;
  EXPECT_EQ(channels, 12u);

  const auto expect_float = [&](const char* name, const std::vector<float>& layer,
                                std::size_t channel, std::size_t stride) {
    ASSERT_EQ(header.channels()[name].type, Imf::FLOAT) << name;
    std::vector<float> read(image.pixels());
    Imf::FrameBuffer buffer;
    buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(read.data()), 4,
                                   std::size_t{4} * image.width));
    input.setFrameBuffer(buffer);
    input.readPixels(0, static_cast<int>(image.height) - 1);
    for (std::size_t i = 0; i < read.size(); ++i)
      EXPECT_EQ(read[i], layer[i * stride + channel]) << name << i;
  };
  expect_float("R", image.radiance, 0, 3);
  expect_float("G", image.radiance, 1, 3);
  expect_float("B", image.radiance, 2, 3);
  expect_float("A", image.coverage, 0, 1);
  expect_float("Z", image.depth, 0, 1);
  expect_float("range", image.range, 0, 1);
  expect_float("N.X", image.normal, 0, 3);
  expect_float("N.Y", image.normal, 1, 3);
  expect_float("N.Z", image.normal, 2, 3);
  const std::pair<const char*, const std::vector<std::uint32_t>&> ids[] = {
      {"id.target", image.target_id},
      {"id.node", image.node_id},
      {"id.material", image.material_id}};
  for (const auto& [name, layer] : ids) {
    ASSERT_EQ(header.channels()[name].type, Imf::UINT) << name;
    std::vector<std::uint32_t> read(image.pixels());
    Imf::FrameBuffer buffer;
    buffer.insert(name, Imf::Slice(Imf::UINT, reinterpret_cast<char*>(read.data()), 4,
                                   std::size_t{4} * image.width));
    input.setFrameBuffer(buffer);
    input.readPixels(0, static_cast<int>(image.height) - 1);
    EXPECT_EQ(read, layer) << name;
  }
}

TEST_F(ImageFiles, SameImageSameBytes) {
  const Image image = numbered(300, 200, true);
  for (const char* extension : {".png", ".exr", ".npy", ".npz"}) {
    DiagnosticLog log;
    const auto a = path("a").replace_extension(extension);
    const auto b = path("b").replace_extension(extension);
    ASSERT_TRUE(write_image(a, image, 0.5, log));
    ASSERT_TRUE(write_image(b, image, 0.5, log));
    EXPECT_EQ(bytes(a), bytes(b)) << extension;
    EXPECT_GT(bytes(a).size(), 128u);
  }
}

}  // namespace
}  // namespace panwright::image::image_test
