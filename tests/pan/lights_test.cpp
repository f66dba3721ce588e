// Lamps and scenes in the file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "pan/diff.h"
#include "pan/model.h"
#include "pan/writer.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::lights_test {
namespace {

using support::problems;
using testing::HasSubstr;

Contents lit() {
  Contents contents = support::small_contents();
  LampContent lamp;
  lamp.name = "docking";
  lamp.node = 1;
  lamp.position = Vec3(1, 2, 3);
  lamp.axis = Vec3(0, 0, 1);
  lamp.intensity = Vec3(4, 5, 6);
  lamp.half_angle = 0.5;
  contents.lamps = {lamp};
  return contents;
}

Model model_of(const Contents& contents) {
  DiagnosticLog log;
  auto model = Model::from_bytes(write_to_memory(contents), "test.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return std::move(*model);
}

TEST(Lights, ComeBack) {
  Contents contents = lit();
  contents.scene = {{"sun", "1 0 0"}, {"planet", "earth=0 0 -6778000"}};
  const Model model = model_of(contents);
  ASSERT_EQ(model.lamps().size(), 1u);
  EXPECT_EQ(model.lamp_name(0), "docking");
  EXPECT_EQ(model.lamps()[0].intensity[2], 6);
  ASSERT_EQ(model.scene().size(), 2u);
  EXPECT_EQ(model.scene_setting_name(1), "planet");
  EXPECT_EQ(model.string(model.scene()[1].value), "earth=0 0 -6778000");
}

// A reader that knows no lamps may take a file whose lamps are all off, and no other.
TEST(Lights, OlderReadersRefuseLight) {
  const auto feature = [](const Contents& contents) {
    return (model_of(contents).header().required_features & layout::kFeatureLights) != 0;
  };
  EXPECT_TRUE(feature(lit()));
  EXPECT_EQ(model_of(lit()).header().minor, 2);
  Contents off = lit();
  off.lamps[0].flags = layout::kLampOff;
  EXPECT_FALSE(feature(off));
  off.scene = {{"sun", "1 0 0"}};
  EXPECT_TRUE(feature(off));
  EXPECT_FALSE(feature(support::small_contents()));
}

TEST(Lights, AreCheckedAgainstTheRules) {
  const auto broken = [](const auto& change) {
    Contents contents = lit();
    change(contents.lamps);
    return problems(contents);
  };
  EXPECT_EQ(problems(lit()), "");
  EXPECT_THAT(broken([](auto& l) { l[0].node = 99; }), HasSubstr("E4010"));
  EXPECT_THAT(broken([](auto& l) { l[0].kind = 3; }), HasSubstr("lamps[0].kind"));
  EXPECT_THAT(broken([](auto& l) { l[0].flags = 4; }), HasSubstr("lamps[0].flags"));
  EXPECT_THAT(broken([](auto& l) { l[0].flags = layout::kLampPulsed; }),
              HasSubstr("pulse that does not end after its begin"));
  EXPECT_THAT(broken([](auto& l) { l[0].axis = Vec3(0, 0, 2); }), HasSubstr("lamps[0].axis"));
  EXPECT_THAT(broken([](auto& l) { l[0].intensity.y = -1; }), HasSubstr("lamps[0].intensity"));
  EXPECT_THAT(broken([](auto& l) { l[0].intensity.y = NAN; }), HasSubstr("lamps[0].intensity"));
  EXPECT_THAT(broken([](auto& l) { l[0].half_angle = 0; }),
              HasSubstr("half_angle outside 0 to pi"));
  EXPECT_THAT(broken([](auto& l) { l[0].half_angle = 3.2; }),
              HasSubstr("half_angle outside 0 to pi"));
  EXPECT_THAT(
      broken([](auto& l) { l[0].kind = static_cast<std::uint32_t>(layout::LampKind::disc); }),
      HasSubstr("disc with a radius"));
  EXPECT_THAT(broken([](auto& l) { l.push_back(l[0]); }), HasSubstr("lamps[1] has no name"));
  EXPECT_THAT(broken([](auto& l) { l[0].name.clear(); }), HasSubstr("lamps[0] has no name"));
}

TEST(Lights, Differences) {
  Contents other = lit();
  other.lamps[0].intensity.x = 40;
  other.scene = {{"stars", "6"}};
  const Differences found = diff(model_of(lit()), model_of(other));
  EXPECT_FALSE(found.same_model());
}

}  // namespace
}  // namespace panwright::pan::lights_test
