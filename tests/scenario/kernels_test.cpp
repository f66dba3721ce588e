#include "scenario/kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/file.h"
#include "scenario/sequence.h"
#include "tests/ephemeris/support.h"

namespace panwright::scenario::kernels_test {
namespace {

namespace sup = ephemeris::testing_support;
using ephemeris::KernelBytes;
using ephemeris::Kernels;

constexpr const char* kFrames =
    "KPL/FK\n\\begindata\nFRAME_CAM = 1400001\nFRAME_1400001_NAME = 'CAM'\n"
    "FRAME_1400001_CLASS = 4\nFRAME_1400001_CLASS_ID = 1400001\nFRAME_1400001_CENTER = -99\n"
    "TKFRAME_1400001_SPEC = 'ANGLES'\nTKFRAME_1400001_RELATIVE = 'ECLIPJ2000'\n"
    "TKFRAME_1400001_ANGLES = ( 90, 0, 0 )\nTKFRAME_1400001_AXES = ( 3, 2, 1 )\n"
    "TKFRAME_1400001_UNITS = 'DEGREES'\n\\begintext\n";

// Orbits of the tests; their bytes stay.
const Kernels& kernels() {
  static const std::string orbit = [] {
    sup::Segment sun = sup::segment(2, 10, 399);
    sun.data = {300, 300, 1.2e8, 0, 9e7, 0, 0, 0, 0, 600, 8, 1};
    return sup::daf("DAF/SPK", {sup::segment(13), sun});
  }();
  static const Kernels out = [] {
    DiagnosticLog log;
    const std::vector<KernelBytes> all{{"orbit.bsp", as_bytes(orbit)},
                                       {"cam.tf", as_bytes(std::string_view(kFrames))}};
    auto read = Kernels::of(all, log);
    EXPECT_TRUE(read) << to_text(log);
    return *std::move(read);
  }();
  return out;
}

SourcePtr source_of(const KernelOptions& options, DiagnosticLog& log) {
  const auto out = kernel_source("orbit.bsp", kernels(), options, log);
  return out ? *out : nullptr;
}

TEST(KernelSource, PositionsInMetres) {
  KernelOptions options;
  options.target = "client";
  options.body = "-99";
  options.observer = "earth";
  DiagnosticLog log;
  const SourcePtr source = source_of(options, log);
  ASSERT_TRUE(source) << to_text(log);
  EXPECT_EQ(source->info().centre, "EARTH");
  EXPECT_EQ(source->info().frame, "EME2000");
  ASSERT_EQ(source->info().spans.size(), 1u);
  // time 0 is ET 0: J2000, 2000-01-01T12:00:00 TDB
  EXPECT_EQ(epoch_text(*source->info().epoch, TimeSystem::tdb), "2000-01-01T12:00:00");
  for (const double t : {0.0, 123.4, 600.0}) {
    Frame frame;
    ASSERT_TRUE(source->at(t, frame, log)) << to_text(log);
    // ET has steps of 1e-7 s here: 7 km/s
    EXPECT_LE(length(*frame.find("client")->placement.position - 1e3 * sup::path(t).position),
              1e-3);
  }
  Frame frame;
  EXPECT_FALSE(source->at(600.1, frame, log));
  EXPECT_TRUE(log.contains(Code("E8003")));
}

TEST(KernelSource, DatesOfTheScenario) {
  KernelOptions options;
  options.body = "-99";
  options.observer = "399";
  std::string problem;
  options.epoch = parse_epoch("2000-01-01T11:59:55.816", TimeSystem::utc, problem);
  options.system = TimeSystem::utc;
  DiagnosticLog log;
  const SourcePtr source = source_of(options, log);
  ASSERT_TRUE(source) << to_text(log);
  // 64.184 s of TT after UTC: ET 60
  EXPECT_NEAR(source->info().spans[0].begin, -60, 1e-4);
  Frame frame;
  ASSERT_TRUE(source->at(0, frame, log));
  EXPECT_LE(length(*frame.camera.position - 1e3 * sup::path(60).position), 1);
}

TEST(KernelSource, AttitudeAndSun) {
  KernelOptions options;
  options.observer = "EARTH";
  options.attitude = "CAM";
  options.frame = "ECLIPJ2000";
  options.sun = true;
  DiagnosticLog log;
  const SourcePtr source = source_of(options, log);
  ASSERT_TRUE(source) << to_text(log);
  Frame frame;
  ASSERT_TRUE(source->at(10, frame, log));
  // v_ecliptic = [90°]3 v_cam: x of the camera lies along −y of the ecliptic
  const Vec3 x = *frame.camera.rotation * Vec3(1, 0, 0);
  EXPECT_LE(length(x - Vec3(0, -1, 0)), 1e-15);
  // (4, 3, 0)/5 of the equator, turned by the obliquity about x
  const double e = 84381.448 / 3600 * kDegree;
  EXPECT_LE(length(*frame.sun_direction - Vec3(0.8, 0.6 * std::cos(e), -0.6 * std::sin(e))), 1e-15);
  EXPECT_NEAR(*frame.sun_distance, 1.5e8 / 149597870.7, 1e-12);
  // they fit sources in other axes no more than two ephemerides do
  KernelOptions other;
  other.target = "client";
  other.body = "-99";
  other.observer = "EARTH";
  const SourcePtr orbit = source_of(other, log);
  EXPECT_FALSE(Sequence::of({{orbit}, {source}}, {}, log));
  EXPECT_TRUE(log.contains(Code("E8009")));
}

TEST(KernelSource, NamesThatNoKernelHas) {
  const auto code = [&](auto change, Code expected) {
    KernelOptions options;
    options.body = "-99";
    options.observer = "EARTH";
    change(options);
    DiagnosticLog log;
    EXPECT_FALSE(source_of(options, log));
    EXPECT_TRUE(log.contains(expected)) << to_text(log);
  };
  code([](KernelOptions& o) { o.body = "nobody"; }, Code("E8013"));
  code([](KernelOptions& o) { o.observer = ""; }, Code("E8013"));
  code([](KernelOptions& o) { o.frame = "NO_FRAME"; }, Code("E8013"));
  code([](KernelOptions& o) { o.aberration = "XLT"; }, Code("E8013"));
  code([](KernelOptions& o) { o.body = ""; }, Code("E8013"));
  code([](KernelOptions& o) { o.observer = "MARS"; }, Code("E8003"));
  code([](KernelOptions& o) { o.frame = "IAU_EARTH"; }, Code("E8003"));
  // light time needs the root
  code([](KernelOptions& o) { o.aberration = "LT"; }, Code("E8003"));
}

}  // namespace
}  // namespace panwright::scenario::kernels_test
