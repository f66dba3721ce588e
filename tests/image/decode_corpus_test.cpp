// Public images against another decoder, and damaged: never a crash, and nothing made up.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/file.h"
#include "image/decode.h"
#include "tests/image/image_oracle.h"

namespace panwright::image::decode_corpus_test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostBytes = 1u << 30;

fs::path corpus() {
  const char* given = std::getenv("PANWRIGHT_CORPUS");
  return given != nullptr && *given != '\0' ? fs::path(given) : fs::path(PANWRIGHT_CORPUS_DIR);
}

std::vector<fs::path> images(const std::string& extension) {
  std::vector<fs::path> out;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(corpus(), error))
    if (entry.is_regular_file() && entry.path().extension() == extension)
      out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

std::string read(const fs::path& path) {
  DiagnosticLog log;
  return *read_file(path, kMostBytes, log);
}

// Returns what the oracle decodes, and sets what ours does; expects that both do or neither.
auto decoded_by_both(const fs::path& path, DecodedImage& image) {
  const std::string bytes = read(path);
  auto oracle = oracle_decoded(bytes);
  const ImageProblem problem = decode_image(as_bytes(bytes), kMostBytes, image);
  EXPECT_EQ(problem.code.has_value(), !oracle.has_value()) << path << problem.message;
  return oracle;
}

TEST(ImageCorpus, PngsAreReadAsByAnotherDecoder) {
  const auto files = images(".png");
  if (files.empty()) GTEST_SKIP() << "no " << corpus();
  for (const fs::path& path : files) {
    DecodedImage image;
    const auto oracle = decoded_by_both(path, image);
    ASSERT_EQ(image.rgba, oracle ? oracle->rgba : image.rgba) << path;
  }
}

// The two decoders round in other places of the inverse DCT and of the interpolation of chroma.
TEST(ImageCorpus, JpegsAreReadAsByAnotherDecoderUpToRounding) {
  const auto files = images(".jpg");
  if (files.empty()) GTEST_SKIP() << "no " << corpus();
  double sum = 0, count = 0;
  for (const fs::path& path : files) {
    DecodedImage image;
    const auto oracle = decoded_by_both(path, image);
    if (!oracle) continue;
    ASSERT_EQ(image.rgba.size(), oracle->rgba.size()) << path;
    int largest = 0;
    for (std::size_t i = 0; i < image.rgba.size(); ++i) {
      const int difference = std::abs(image.rgba[i] - oracle->rgba[i]);
      largest = std::max(largest, difference);
      sum += difference;
    }
    count += 0.75 * static_cast<double>(image.rgba.size());
    ASSERT_LE(largest, 3) << path;
  }
  EXPECT_LE(sum / count, 0.03);  // measured 0.024 of 255
}

}  // namespace
}  // namespace panwright::image::decode_corpus_test
