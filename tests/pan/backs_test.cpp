// Backs with materials of their own, in the file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "pan/diff.h"
#include "pan/model.h"
#include "pan/writer.h"
#include "tests/support/pan_sample.h"

namespace panwright::pan::backs_test {
namespace {

using support::problems;
using testing::HasSubstr;

// The first instance with another material on its back.
Contents sided() {
  Contents contents = support::small_contents();
  for (PackedMesh& mesh : contents.meshes) mesh.closed = false;
  contents.instances[0].material = 0;
  contents.instances[0].back = 1;
  contents.materials[1] = contents.materials[0];
  contents.materials[1].name = "inner";
  return contents;
}

Model model_of(const Contents& contents) {
  DiagnosticLog log;
  auto model = Model::from_bytes(write_to_memory(contents), "test.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return std::move(*model);
}

TEST(Backs, ComeBackByInstance) {
  const Model model = model_of(sided());
  ASSERT_EQ(model.backs().size(), 1u);
  EXPECT_EQ(model.back_of(0), 1);
  EXPECT_EQ(model.back_of(1), -1);
  EXPECT_EQ(model.back_of(999), -1);
  // a reader that knows none would show the front on both sides: it must not take the file
  EXPECT_NE(model.header().required_features & layout::kFeatureBacks, 0u);
  EXPECT_EQ(model.header().minor, 1);

  Contents bare = sided();
  bare.instances[0].back = -1;
  const Model other = model_of(bare);
  EXPECT_TRUE(other.backs().empty());
  EXPECT_EQ(other.header().required_features & layout::kFeatureBacks, 0u);
  EXPECT_EQ(other.directory().size() + 1, model.directory().size());
}

TEST(Backs, AreCheckedAgainstTheRules) {
  EXPECT_EQ(problems(sided()), "");
  const auto broken = [](const auto& change) {
    Contents contents = sided();
    change(contents);
    return problems(contents);
  };
  EXPECT_THAT(broken([](Contents& c) { c.instances[0].back = 99; }), HasSubstr("E4010"));
  EXPECT_THAT(broken([](Contents& c) { c.meshes[c.instances[0].mesh].closed = true; }),
              HasSubstr("backs[0] is of a closed mesh"));
  EXPECT_THAT(broken([](Contents& c) { c.materials[1].maps.cutout = 0; }),
              HasSubstr("backs[0].material has other holes"));
  EXPECT_THAT(broken([](Contents& c) {
                c.meshes[c.instances[0].mesh].texcoords.clear();
                c.instances[0].texture = -1;
                c.materials[0].maps = {};
                c.materials[1].maps.albedo = 0;
              }),
              HasSubstr("backs[0] has a material with maps"));
}

TEST(Backs, HolesAreThoseOfTheFront) {
  Contents contents = sided();
  contents.instances[0].mesh = contents.instances[1].mesh;  // with texture coordinates
  for (materials::Material* one : {&contents.materials[0], &contents.materials[1]}) {
    one->maps.cutout = 0;
    one->maps.threshold = 0.25;
    one->maps.repeat = Vec2(2, 3);
  }
  EXPECT_EQ(problems(contents), "");
  // a closed mesh with holes shows its inside
  contents.meshes[contents.instances[0].mesh].closed = true;
  EXPECT_EQ(problems(contents), "");
  contents.materials[1].maps.threshold = 0.5;
  EXPECT_THAT(problems(contents), HasSubstr("other holes"));
  contents.materials[1].maps.threshold = 0.25;
  contents.materials[1].maps.repeat.y = 2;
  EXPECT_THAT(problems(contents), HasSubstr("other holes"));
}

TEST(Backs, AreComparedByTheMaterialsTheyName) {
  const Model a = model_of(sided());
  EXPECT_TRUE(diff(a, model_of(sided())).model.empty());
  Contents bare = sided();
  bare.instances[0].back = -1;
  const auto found = diff(a, model_of(bare));
  ASSERT_EQ(found.model.size(), 1u);
  EXPECT_EQ(found.model[0].what, "on its back material 'inner' in a, that of the front in b");
}

}  // namespace
}  // namespace panwright::pan::backs_test
