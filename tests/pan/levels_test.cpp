// Levels of detail in the file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "pan/diff.h"
#include "pan/model.h"
#include "pan/writer.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::levels_test {
namespace {

using support::problems;
using testing::HasSubstr;

Contents leveled() {
  Contents contents = support::small_contents();
  contents.decals.clear();
  contents.levels = {{0.5, 0.25, 0, 1, 1, 0}, {0.125, 0.5, 1, 1, 0, 0}, {0.75, 1, 1, 1, 1, 0}};
  return contents;
}

TEST(Levels, ComeBackByInstance) {
  DiagnosticLog log;
  auto model = Model::from_bytes(write_to_memory(leveled()), "test.pan", log);
  ASSERT_TRUE(model && model->check(log)) << to_text(log);
  ASSERT_EQ(model->levels().size(), 3u);
  ASSERT_EQ(model->levels(0).size(), 1u);
  EXPECT_EQ(model->levels(0)[0].detail, 0.5);
  EXPECT_EQ(model->levels(0)[0].error, 0.25);
  EXPECT_EQ(model->levels(0)[0].mesh, 1u);
  ASSERT_EQ(model->levels(1).size(), 2u);
  EXPECT_EQ(model->levels(1)[1].detail, 0.75);
  EXPECT_EQ(model->levels(1)[1].material, 1u);
  EXPECT_TRUE(model->levels(2).empty());
  // absent where there are none: the bytes of models without are as ever
  Contents bare = leveled();
  bare.levels.clear();
  EXPECT_EQ(write_to_memory(bare).size() % 8, 0u);
  auto other = Model::from_bytes(write_to_memory(bare), "test.pan", log);
  ASSERT_TRUE(other && other->check(log));
  EXPECT_EQ(other->directory().size() + 1, model->directory().size());
}

TEST(Levels, AreCheckedAgainstTheRules) {
  EXPECT_EQ(problems(leveled()), "");
  const auto broken = [](const auto& change) {
    Contents contents = leveled();
    change(contents);
    return problems(contents);
  };
  EXPECT_THAT(broken([](Contents& c) { c.levels[0].detail = 0; }),
              HasSubstr("levels[0].detail is 0, expected more than 0"));
  EXPECT_THAT(broken([](Contents& c) { c.levels[2].detail = 0.125; }),
              HasSubstr("levels[2] is out of order"));
  EXPECT_THAT(broken([](Contents& c) { std::swap(c.levels[0], c.levels[2]); }),
              HasSubstr("out of order"));
  EXPECT_THAT(broken([](Contents& c) { c.levels[1].instance = 3; }), HasSubstr("E4010"));
  EXPECT_THAT(broken([](Contents& c) { c.levels[1].mesh = 2; }), HasSubstr("E4010"));
  EXPECT_THAT(broken([](Contents& c) { c.levels[1].material = 9; }), HasSubstr("E4010"));
  EXPECT_THAT(broken([](Contents& c) { c.levels[1].error = -1; }), HasSubstr("E4012"));
  EXPECT_THAT(broken([](Contents& c) { c.levels[1].detail = HUGE_VAL; }), HasSubstr("E4012"));
  EXPECT_THAT(broken([](Contents& c) { c.decals = support::small_contents().decals; }),
              HasSubstr("decals[0] is on an instance with levels"));
  // the second instance has a texture, and the first mesh no coordinates for it
  EXPECT_THAT(broken([](Contents& c) { c.levels[1].mesh = 0; }),
              HasSubstr("levels[1] has a texture, but meshes[0] has no texcoords"));
  EXPECT_THAT(broken([](Contents& c) {
                c.nodes[1].scale = Vec3(1e300);
                c.meshes[1].origin = Vec3(1e300);
              }),
              HasSubstr("not finite"));
}

TEST(Levels, DifferencesAreNamed) {
  DiagnosticLog log;
  const auto load = [&](const Contents& contents) {
    auto model = Model::from_bytes(write_to_memory(contents), "test.pan", log);
    EXPECT_TRUE(model && model->check(log)) << to_text(log);
    return *std::move(model);
  };
  Contents changed = leveled();
  changed.levels[0].error = 2;
  changed.levels[2].material = 0;
  changed.levels.erase(changed.levels.begin() + 1);
  const Model a = load(leveled()), b = load(changed);
  std::string all;
  for (const Difference& difference : diff(a, b).model)
    all += difference.where + ": " + difference.what + "\n";
  EXPECT_THAT(all, HasSubstr("level mesh 'pl\u00e4t\u00e9' of mesh 'hull'"));
  EXPECT_THAT(all, HasSubstr("error: 0.25 in a, 2 in b"));
}

}  // namespace
}  // namespace panwright::pan::levels_test
