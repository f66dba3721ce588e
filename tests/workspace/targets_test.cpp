#include "workspace/targets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/process.h"

namespace panwright::workspace::targets_test {
namespace {

using support::TemporaryFolder;

std::string ball(const TemporaryFolder& folder, const std::string& name, double radius = 1) {
  return folder.write(name, "<pangu_model ver=\"1\"><sphere radius=\"" + std::to_string(radius) +
                                "\"/></pangu_model>");
}

TEST(TargetFile, IsCalledByItsStemOrAsItSays) {
  const auto is = [](const char* text, const char* name, const char* file) {
    const TargetFile target = target_file(text);
    EXPECT_EQ(target.name, name) << text;
    EXPECT_EQ(target.file, file) << text;
  };
  is("client.pan", "client", "client.pan");
  is("models/client.pan", "client", "models/client.pan");
  is("iss.wrl.gz", "iss", "iss.wrl.gz");
  is("a=models/client.pan", "a", "models/client.pan");
  is("a b=x=y.pan", "a b", "x=y.pan");
  is("models/a=b.pan", "a=b", "models/a=b.pan");  // no name has a slash
  is("=b.pan", "=b", "=b.pan");
  is("a=", "a=", "a=");
}

TEST(TargetFile, AFileThatIsThereIsTakenAsItIs) {
  const TemporaryFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  ball(folder, "a=b.pxn");
  EXPECT_EQ(target_file("a=b.pxn").name, "a=b");
  EXPECT_EQ(target_file("a=c.pxn").name, "a");
  std::filesystem::current_path(before);
}

TEST(OpenWorld, SharesTheModelOfAFileThatIsGivenTwice) {
  const TemporaryFolder folder;
  const std::string file = ball(folder, "ball.pxn");
  const std::string same = (folder.path() / "." / "ball.pxn").string();
  const TargetFile files[] = {{"a", file}, {"b", same}, {"c", ball(folder, "other.pxn", 2)}};
  DiagnosticLog log;
  OpenReport report;
  const auto world = open_world(files, {}, log, {}, &report);
  ASSERT_TRUE(world) << to_text(log);
  ASSERT_EQ(world->size(), 3u);
  EXPECT_EQ((*world)[0].model(), (*world)[1].model());
  EXPECT_NE((*world)[0].model(), (*world)[2].model());
  EXPECT_EQ((*world)[2].name(), "c");
  EXPECT_EQ(report.steps.size(), 4u) << "two readings and two compilations";
}

TEST(OpenWorld, RefusesTwoTargetsOfOneNameAndNone) {
  const TemporaryFolder folder;
  DiagnosticLog log;
  const TargetFile twice[] = {{"a", folder / "none.pan"}, {"a", folder / "neither.pan"}};
  EXPECT_FALSE(open_world(twice, {}, log));
  ASSERT_EQ(log.entries().size(), 1u) << "nothing is opened first";
  EXPECT_EQ(log.entries()[0].code, Code("E5009"));
  EXPECT_THAT(log.entries()[0].message, testing::HasSubstr("neither.pan"));
  DiagnosticLog none;
  EXPECT_FALSE(open_world({}, {}, none));
  EXPECT_TRUE(none.contains(Code("E5030")));
}

TEST(BoundingSpheres, HoldEachTargetAndAllOfThem) {
  const TemporaryFolder folder;
  const TargetFile files[] = {{"a", ball(folder, "a.pxn")}, {"b", ball(folder, "b.pxn", 3)}};
  DiagnosticLog log;
  auto world = open_world(files, {}, log);
  ASSERT_TRUE(world);
  world->set_pose(1, {{10, 0, 0}, {1, 0, 0, 0}});
  BoundingSpheres spheres;
  const BoundingSphere a = spheres.of((*world)[0]);
  const BoundingSphere b = spheres.of((*world)[1]);
  // the sphere about the box of a ball
  EXPECT_NEAR(a.radius, std::sqrt(3.0), 2e-3);
  EXPECT_NEAR(b.radius, 3 * std::sqrt(3.0), 6e-3);
  EXPECT_NEAR(glm::length(b.centre - Vec3(10, 0, 0)), 0, 1e-3);
  const BoundingSphere all = spheres.of(*world);
  for (const BoundingSphere& each : {a, b})
    EXPECT_LE(glm::length(each.centre - all.centre) + each.radius, all.radius * (1 + 1e-12));
  // on one line: no larger than both one behind the other
  EXPECT_LE(all.radius, 0.5 * (10 + a.radius + b.radius) * (1 + 1e-6));
  world->set_visible(1, false);
  EXPECT_EQ(spheres.of(*world).centre, a.centre);
  EXPECT_EQ(spheres.of(*world).radius, a.radius);
  world->set_visible(0, false);
  EXPECT_EQ(spheres.of(*world).radius, 1);
}

}  // namespace
}  // namespace panwright::workspace::targets_test
