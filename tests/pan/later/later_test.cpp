// What a program of a later format does with the files of today: this is built against a layout
// whose records have grown (growth.toml). The corpus test is built with it too.
#include <gtest/gtest.h>

#include <filesystem>

#include "pan/diff.h"
#include "pan/model.h"
#include "tests/support/pan_sample.h"
#include "tests/support/paths.h"

namespace panwright::pan::later_test {
namespace {

using layout::SectionKind;

static_assert(layout::kMinor == 9);
static_assert(sizeof(layout::Instance) == 24 && sizeof(layout::Keypoint) == 40);

void expect_defaults(const Model& model) {
  for (const layout::Instance& instance : model.instances()) {
    EXPECT_EQ(instance.gain, 1.5f);
    EXPECT_EQ(instance.layers, 7u);
  }
  for (const layout::Keypoint& point : model.keypoints()) EXPECT_EQ(point.sigma, 0.25);
}

TEST(Later, OldRecordsGetDefaults) {
  std::size_t instances = 0, keypoints = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(PANWRIGHT_SOURCE_DIR "/tests/pan/data/1.0")) {
    if (file.path().extension() != ".pan") continue;
    DiagnosticLog log;
    const auto model = Model::load(file.path(), log);
    ASSERT_TRUE(model) << to_text(log);
    EXPECT_EQ(model->unpacked_bytes(),
              24 * model->instances().size() + 40 * model->keypoints().size());
    expect_defaults(*model);
    instances += model->instances().size();
    keypoints += model->keypoints().size();
  }
  EXPECT_GT(instances, 20u);
  EXPECT_GT(keypoints, 5u);
}

// Shortens the records of a file of the later format to those of 1.0.
std::vector<std::byte> as_of_old(std::vector<std::byte> bytes) {
  support::OpenPan file(std::move(bytes));
  file.restride_section(SectionKind::instances, 16);
  file.restride_section(SectionKind::keypoints, 32);
  file.header().required_features = 0;
  file.header().minor = 0;
  return file.seal().bytes();
}

TEST(Later, FilesOfBothFormatsAreOneModel) {
  pan::Contents contents = support::small_contents();
  const std::vector<std::byte> now = write_to_memory(contents);
  DiagnosticLog log;
  auto later = Model::from_bytes(now, "later", log);
  auto old = Model::from_bytes(as_of_old(now), "old", log);
  ASSERT_TRUE(later && later->check(log) && old && old->check(log)) << to_text(log);
  EXPECT_EQ(later->header().minor, 9);
  EXPECT_EQ(later->header().required_features, layout::kFeatureRecordSizes);
  EXPECT_EQ(later->unpacked_bytes(), 0u);
  expect_defaults(*old);
  EXPECT_EQ(later->instances()[0].gain, 0.0f);  // the writer's value
  const Differences differences = diff(*later, *old);
  for (const Difference& each : differences.model)
    EXPECT_TRUE(each.what.starts_with("sigma: ")) << each.where << " " << each.what;
  EXPECT_TRUE(differences.provenance.empty());
}

TEST(Later, RulesHoldForWhatWasAdded) {
  support::OpenPan file(write_to_memory(support::small_contents()));
  file.at<layout::Instance>(SectionKind::instances, 1).gain = -1;
  DiagnosticLog log;
  auto model = Model::from_bytes(file.seal().bytes(), "later", log);
  ASSERT_TRUE(model && !model->check(log));
  EXPECT_EQ(log.entries()[0].message,
            "instances[1].gain is -1, expected a finite number of at least 0");
}

}  // namespace
}  // namespace panwright::pan::later_test
