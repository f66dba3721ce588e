// Tables of frames: units, directions of quaternions, problems with their places.
#include "scenario/csv.h"

#include <gtest/gtest.h>

#include "tests/scenario/support.h"

namespace panwright::scenario::csv_test {
namespace {

using support::at;
using support::codes;
using support::first_line;
using support::turn_between;

SourcePtr read(const std::string& text, const CsvOptions& options = {}) {
  DiagnosticLog log;
  auto source = read_csv(memory_text("t.csv", text), options, log);
  EXPECT_TRUE(source) << to_text(log);
  EXPECT_EQ(codes(log), "");
  return source ? *source : nullptr;
}

// "E8001:3": the codes and the line of the first.
std::string problem(const std::string& text, const CsvOptions& options = {}) {
  DiagnosticLog log;
  (void)read_csv(memory_text("t.csv", text), options, log);
  return codes(log) + ":" + std::to_string(first_line(log));
}

TEST(Csv, UnitsAndMembers) {
  const auto source = read(
      "# from a simulator\n"
      "time[ms],client.x[km],client.y[m],client.z[mm],client.joint.wing[deg],"
      "client.joint.arm:2[cm],camera.fov[deg],sun.x,sun.y,sun.z,sun.distance[km],name,seed\n"
      "0,1,2,3,90,5,20,0,0,2,149597870.7,\"a \"\"b\"\"\",7\n"
      "500,2,2,3,180,7,30,0,2,0,299195741.4,second,18446744073709551615\n");
  ASSERT_TRUE(source);
  const Frame first = at(*source, 0);
  const TargetState& client = first.targets.at(0);
  EXPECT_EQ(client.name, "client");
  EXPECT_EQ(client.placement.position, Vec3(1000, 2, 0.003));
  EXPECT_FALSE(client.placement.rotation);
  EXPECT_EQ(client.joints.at(0).values[0], kPi / 2);
  EXPECT_EQ(client.joints.at(0).count, 1u);
  EXPECT_EQ(client.joints.at(1).values[1], 0.05);
  EXPECT_EQ(client.joints.at(1).count, 2u);
  EXPECT_EQ(first.name, "a \"b\"");
  EXPECT_EQ(first.seed, 7u);
  EXPECT_NEAR(*first.sun_distance, 1, 1e-15);
  EXPECT_FALSE(first.camera.position);
  const Frame middle = at(*source, 0.25);
  EXPECT_EQ(middle.targets.at(0).placement.position, Vec3(1500, 2, 0.003));
  EXPECT_NEAR(*middle.lens.fov, 25 * kDegree, 1e-15);
  EXPECT_NEAR(middle.sun_direction->y, std::sqrt(0.5), 1e-15);
  EXPECT_EQ(middle.name, "");
  EXPECT_FALSE(middle.seed);
  EXPECT_EQ(at(*source, 0.5).seed, ~std::uint64_t{0});
}

// x to y, y to z, z to x: 120 degrees about (1, 1, 1), and then 90 about z.
TEST(Csv, DirectionOfQuaternions) {
  const auto turn = [](const std::string& direction, const std::string& numbers) {
    const std::string q = "[" + direction + "]";
    const auto source = read("b.qw" + q + ",b.qx" + q + ",b.qy" + q + ",b.qz" + q + "\n" + numbers);
    Frame frame;
    DiagnosticLog log;
    if (source) EXPECT_TRUE(source->frame(0, frame, log));
    return frame.targets.at(0).placement.rotation.value_or(Quat(1, 0, 0, 0));
  };
  const double s = std::sqrt(0.5);
  const Quat world_from_model(s, 0, 0, s);  // x of the model is y of the world
  EXPECT_NEAR(
      (turn("world_from_model", "0.7071067811865476,0,0,0.7071067811865476") * Vec3(1, 0, 0)).y, 1,
      1e-15);
  EXPECT_LT(turn_between(turn("model_from_world", "0.7071067811865476,0,0,-0.7071067811865476"),
                         world_from_model),
            1e-15);
  EXPECT_LT(turn_between(turn("body_from_world", "0.7071067811865476,0,0,-0.7071067811865476"),
                         world_from_model),
            1e-15);
}

TEST(Csv, Epochs) {
  const auto text = read(
      "time[UTC];camera.x[m];camera.y[m];camera.z[m]\n"
      "2016-12-31T23:59:59;0;0;0\n2017-01-01T00:00:01;3;0;0\n");
  EXPECT_EQ(text->info().times, (std::vector<double>{0, 3}));  // a leap second is in between
  const auto since = read(
      "time[h since 2026-01-01T00:00:00 TAI]\tcamera.x[m]\tcamera.y[m]\tcamera.z[m]\n"
      "1\t0\t0\t0\n2\t3\t0\t0\n");
  EXPECT_EQ(since->info().times, (std::vector<double>{3600, 7200}));
  EXPECT_EQ(epoch_text(*since->info().epoch, TimeSystem::tai), "2026-01-01T00:00:00");
}

TEST(Csv, OrderWithoutTimes) {
  const auto source = read("camera.x[m],camera.y[m],camera.z[m]\n1,2,3\n4,5,6\n");
  EXPECT_EQ(source->frames(), 2u);
  Frame frame;
  DiagnosticLog log;
  EXPECT_TRUE(source->frame(1, frame, log));
  EXPECT_EQ(frame.camera.position, Vec3(4, 5, 6));
  EXPECT_FALSE(source->at(0, frame, log));
  EXPECT_EQ(codes(log), "E8009");
}

TEST(Csv, HermiteFromVelocities) {
  CsvOptions options;
  options.method = Method::hermite;
  options.degree = 3;
  const auto source = read(
      "time[s],a.x[m],a.y[m],a.z[m],a.vx[mm/s],a.vy[mm/s],a.vz[mm/s]\n0,0,0,0,0,0,0\n"
      "2,8,4,0,12000,4000,0\n",
      options);
  EXPECT_LT(length(*at(*source, 1.5).targets.at(0).placement.position - Vec3(3.375, 2.25, 0)),
            1e-14);
}

TEST(Csv, Problems) {
  const std::string xyz = "a.x[m],a.y[m],a.z[m]";
  EXPECT_EQ(problem(""), "E8001:1");
  EXPECT_EQ(problem("# nothing\n"), "E8001:1");
  EXPECT_EQ(problem("time[s]," + xyz + "\n"), "E8001:1");
  EXPECT_EQ(problem("time[s]\n1\n"), "E8001:1");
  EXPECT_EQ(problem("time," + xyz + "\n1,2,3,4\n"), "E8001:1");           // no unit
  EXPECT_EQ(problem("time[s],a.x,a.y[m],a.z[m]\n1,2,3,4\n"), "E8001:1");  // no unit
  EXPECT_EQ(problem("time[s],a.x[ft],a.y[m],a.z[m]\n1,2,3,4\n"), "E8001:1");
  EXPECT_EQ(problem("time[s],a.x[m],a.y[m]\n1,2,3\n"), "E8001:1");  // no z
  EXPECT_EQ(problem("time[s],a.x[m,a.y[m],a.z[m]\n1,2,3,4\n"), "E8001:1");
  EXPECT_EQ(problem(xyz + ",a.vx[m/s],a.vy[m/s]\n1,2,3,4,5\n"), "E8001:1");
  EXPECT_EQ(problem("b.vx[m/s],b.vy[m/s],b.vz[m/s]," + xyz + "\n1,2,3,4,5,6\n"), "E8001:1");
  EXPECT_EQ(problem(xyz + ",a.x[km]\n1,2,3,4\n"), "E8008:1");
  EXPECT_EQ(problem("time[s],time[UTC]," + xyz + "\n"), "E8008:1");
  EXPECT_EQ(problem("time[UT1]," + xyz + "\n"), "E8001:1");
  EXPECT_EQ(problem("time[s since 2026-01-01T00:00:00]," + xyz + "\n"), "E8007:1");
  EXPECT_EQ(problem("time[s]," + xyz + "\n0,1,2,3\n1,1,2\n"), "E8001:3");
  EXPECT_EQ(problem("time[s]," + xyz + "\n0,1,2,3\n1,1,x,3\n"), "E8001:3");
  EXPECT_EQ(problem("time[s]," + xyz + "\n0,1,2,3\n1,1,nan,3\n"), "E8001:3");
  EXPECT_EQ(problem("time[s]," + xyz + "\n1,1,2,3\n\n1,1,2,3\n"), "E8004:4");
  EXPECT_EQ(problem("time[s]," + xyz + "\n1,1,2,3\n0,1,2,3\n"), "E8004:3");
  EXPECT_EQ(problem(xyz + ",name\n1,2,3,\"open\n"), "E8001:2");
  EXPECT_EQ(problem(xyz + ",seed\n1,2,3,-1\n"), "E8001:2");
  EXPECT_EQ(problem(xyz + ",sun.x,sun.y,sun.z\n1,2,3,0,0,0\n"), "E8001:2");
  EXPECT_EQ(problem(xyz + ",sun.distance[AU]\n1,2,3,0\n"), "E8001:2");
  EXPECT_EQ(problem(xyz + ",a.joint.:3[deg]\n1,2,3,0\n"), "E8001:1");
  EXPECT_EQ(problem(xyz + ",a.joint.b:10[deg]\n1,2,3,0\n"), "E8001:1");
  EXPECT_EQ(problem(xyz + ",colour[m]\n1,2,3,4\n"), "W8002:1");
  CsvOptions strict;
  strict.strict = true;
  EXPECT_EQ(problem(xyz + ",colour[m]\n1,2,3,4\n", strict), "E8001:1");
  EXPECT_EQ(problem("time[s]," + xyz + "\n0,1,2,3\n1,1,2,3\n2,1,2,3\n40,1,2,3\n"), "W8011:1");
}

TEST(Csv, Quaternions) {
  const std::string header =
      "c.qw[world_from_model],c.qx[world_from_model],c.qy[world_from_model],"
      "c.qz[world_from_model]\n";
  EXPECT_EQ(problem(header + "1,0,0,0\n0.7,0.7,0,0\n"), "W8006:3");
  EXPECT_EQ(problem(header + "0.7,0.7,0,0\n0.7,0.7,0,0\n0.7,0.7,0,0\n"),
            "W8006 W8006:2");  // and 2 more
  EXPECT_EQ(problem(header + "0.70711,0.70711,0,0\n"), ":0");
  EXPECT_EQ(problem(header + "nan,0,0,0\n"), "E8001:2");
  EXPECT_EQ(problem(header + "0,0,0,0\n"), "E8005:2");
  EXPECT_EQ(problem(header + "3,0,0,0\n"), "E8005:2");
  EXPECT_EQ(problem(header + "1e300,0,0,0\n"), "E8005:2");
  EXPECT_EQ(problem("c.qw,c.qx,c.qy,c.qz\n1,0,0,0\n"), "E8001 E8001 E8001 E8001:1");
  EXPECT_EQ(problem("camera.qw[world_from_model],camera.qx[world_from_model],"
                    "camera.qy[world_from_model],camera.qz[world_from_model]\n1,0,0,0\n"),
            "E8001 E8001 E8001 E8001:1");
  EXPECT_EQ(problem("c.qw[world_from_model],c.qx[model_from_world],c.qy[world_from_model],"
                    "c.qz[world_from_model]\n1,0,0,0\n"),
            "E8001:1");
}

// Reading ends early however many lines are wrong.
TEST(Csv, ManyErrors) {
  std::string text = "a.x[m],a.y[m],a.z[m]\n";
  for (int i = 0; i < 100000; ++i) text += "1,2\n";
  DiagnosticLog log(1000);
  EXPECT_FALSE(read_csv(memory_text("t.csv", text), {}, log));
  EXPECT_LE(log.entries().size(), 21u);
}

}  // namespace
}  // namespace panwright::scenario::csv_test
