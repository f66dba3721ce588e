// Kernels that the tests write, whose answers are closed forms.

#include "ephemeris/kernels.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "base/file.h"
#include "tests/ephemeris/support.h"

namespace panwright::ephemeris::kernels_test {
namespace {

using namespace testing_support;

// Bytes of kernels, which stay for them.
class Shelf {
 public:
  explicit Shelf(std::vector<std::string> texts) : texts_(std::move(texts)) {}
  std::optional<Kernels> load(DiagnosticLog& log) const {
    std::vector<KernelBytes> all;
    for (const std::string& each : texts_) all.push_back({"k", as_bytes(each)});
    auto out = Kernels::of(all, log);
    return out ? std::optional<Kernels>(*out) : std::nullopt;
  }
  Kernels load() const {
    DiagnosticLog log;
    auto out = load(log);
    EXPECT_TRUE(out) << to_text(log);
    return *out;
  }

 private:
  std::vector<std::string> texts_;
};

constexpr int kTypes[] = {1, 2, 3, 8, 9, 12, 13, 18, 19, 21};

TEST(Kernels, EachSpkTypeInBothByteOrders) {
  for (const Order order : {Order::little, Order::big})
    for (const int type : kTypes) {
      const Shelf shelf({daf("DAF/SPK", {segment(type)}, order)});
      const Kernels kernels = shelf.load();
      std::string problem;
      for (double t = 0; t <= 600; t += 7.5) {
        const auto found = kernels.state(-99, 399, kJ2000, t, Aberration::none, problem);
        ASSERT_TRUE(found) << type << " " << problem;
        // residuals 2e-12 km of 7000, 4e-14 km/s of 7
        EXPECT_LE(length(found->state.position - path(t).position), 2e-11) << type << " " << t;
        EXPECT_LE(length(found->state.velocity - path(t).velocity), 1e-12) << type << " " << t;
      }
      for (const double t : {-0.001, 600.001}) {
        EXPECT_FALSE(kernels.state(-99, 399, kJ2000, t, Aberration::none, problem));
        EXPECT_NE(problem.find("at that time"), problem.npos) << problem;
      }
    }
}

TEST(Kernels, OldFilesWithoutTheirFormat) {
  for (const Order order : {Order::little, Order::big}) {
    const Shelf shelf({DafWriter("NAIF/DAF", order, "").write({segment(2), segment(13)})});
    EXPECT_EQ(shelf.load().segments().size(), 2u);
    EXPECT_EQ(shelf.load().segments()[1].kind, "SPK type 13");
  }
}

TEST(Kernels, OtherTypesAreRefusedByName) {
  for (const int type : {5, 10, 14, 15, 17, 20}) {
    const Shelf shelf({daf("DAF/SPK", {segment(2), segment(type)})});
    DiagnosticLog log;
    const auto kernels = shelf.load(log);
    ASSERT_TRUE(kernels);
    EXPECT_TRUE(log.contains(Code("W8016"))) << to_text(log);
    std::string problem;
    // never an earlier segment in its place
    EXPECT_FALSE(kernels->state(-99, 399, kJ2000, 10, Aberration::none, problem));
    EXPECT_NE(problem.find(fmt::format("type {}, which is not read", type)), problem.npos)
        << problem;
  }
  for (const char* other : {"DAS/DSK ", "NAIF/DAS", "hello"}) {
    DiagnosticLog log;
    EXPECT_FALSE(Shelf({std::string(other) + std::string(2000, ' ')}).load(log));
    EXPECT_TRUE(log.contains(Code("E8015")));
  }
}

TEST(Kernels, LaterSegmentsAndFilesWin) {
  Segment first = segment(3), second = segment(2);
  second.begin = 100;
  second.end = 200;
  second.data = segment_numbers(2);
  for (const std::size_t x : {2u, 16u}) second.data[x] += 5;  // of its parts to 400 s
  std::string problem;
  const auto x_at = [&](const Kernels& kernels, double t) {
    return kernels.state(-99, 399, kJ2000, t, Aberration::none, problem)->state.position.x -
           path(t).position.x;
  };
  const Shelf in_one({daf("DAF/SPK", {first, second})}),
      in_two({daf("DAF/SPK", {first}), daf("DAF/SPK", {second})}),
      turned_round({daf("DAF/SPK", {second, first})});
  const Kernels one = in_one.load(), two = in_two.load();
  for (const Kernels* kernels : {&one, &two}) {
    EXPECT_NEAR(x_at(*kernels, 99.9), 0, 1e-9);
    EXPECT_NEAR(x_at(*kernels, 100), 5, 1e-9);
    EXPECT_NEAR(x_at(*kernels, 150), 5, 1e-9);
    EXPECT_NEAR(x_at(*kernels, 200), 5, 1e-9);
    EXPECT_NEAR(x_at(*kernels, 200.1), 0, 1e-9);
  }
  const Kernels covered = turned_round.load();
  EXPECT_NEAR(x_at(covered, 150), 0, 1e-9);
}

// A chain over the root, light time and aberration of bodies that stand and move evenly.
TEST(Kernels, ChainsAndAberration) {
  const auto even = [](const Vec3& at, const Vec3& v) {
    std::vector<double> out;
    for (int i = 0; i < 2; ++i) append(out, {at + v * (i == 0 ? -1e5 : 1e5), v});
    out.insert(out.end(), {-1e5, 2e5, 1.0, 2.0});
    return out;
  };
  const Vec3 far(1.5e8, 2e7, -3e6), v(1, -20, 4), ours(30, 0, 0);
  const Shelf shelf({daf("DAF/SPK", {{{499, 4, 1, 8}, -1e5, 1e5, even(far, v)},
                                     {{4, 0, 1, 8}, -1e5, 1e5, even(Vec3(0), Vec3(0))},
                                     {{399, 0, 1, 8}, -1e5, 1e5, even(Vec3(0), ours)}})});
  const Kernels kernels = shelf.load();
  std::string problem;
  EXPECT_EQ(kernels.state(399, 499, kJ2000, 0, Aberration::none, problem)->state.position, -far);
  const auto cn = kernels.state(499, 399, kJ2000, 0, Aberration::cn, problem);
  ASSERT_TRUE(cn) << problem;
  // |far − v·lt| = c·lt
  const double a = dot(v, v) - kLightSpeed * kLightSpeed, b = -2 * dot(far, v), c = dot(far, far);
  const double exact = (-b - std::sqrt(b * b - 4 * a * c)) / (2 * a);
  EXPECT_NEAR(cn->light_time, exact, 1e-9);
  EXPECT_LE(length(cn->state.position - (far - v * exact)), 1e-7);
  const auto lt = kernels.state(499, 399, kJ2000, 0, Aberration::lt, problem);
  EXPECT_NEAR(lt->light_time, length(far - v * length(far) / kLightSpeed) / kLightSpeed, 1e-9);
  // velocity: the slope of the position
  const auto next = kernels.state(499, 399, kJ2000, 10, Aberration::cn, problem);
  EXPECT_LE(length((next->state.position - cn->state.position) / 10.0 - cn->state.velocity), 1e-7);
  // aberration turns by the sine of v/c towards the motion, and keeps the distance
  const auto s = kernels.state(499, 399, kJ2000, 0, Aberration::cn_s, problem);
  const double angle = angle_between(s->state.position, cn->state.position);
  const double across = length(cross(normalize(cn->state.position), ours / kLightSpeed));
  EXPECT_NEAR(angle, std::asin(across), 1e-12);
  EXPECT_NEAR(length(s->state.position), length(cn->state.position), 1e-6);
  EXPECT_LT(angle_between(s->state.position, ours), angle_between(cn->state.position, ours));
  EXPECT_FALSE(kernels.state(499, 301, kJ2000, 0, Aberration::none, problem));
  EXPECT_NE(problem.find("MOON (301)"), problem.npos) << problem;
}

constexpr const char* kClock =
    "KPL/SCLK\n\\begindata\nSCLK_DATA_TYPE_99 = ( 1 )\nSCLK01_TIME_SYSTEM_99 = ( 1 )\n"
    "SCLK01_N_FIELDS_99 = ( 2 )\nSCLK01_MODULI_99 = ( 4294967296 10 )\n"
    "SCLK01_COEFFICIENTS_99 = ( 0 0 1.0E0\n 1000 100.0 2.0D0 )\n\\begintext\n";
constexpr const char* kFrames =
    "KPL/FK\n\\begindata\nFRAME_TEST_CRAFT = -99000\nFRAME_-99000_NAME = 'TEST_CRAFT'\n"
    "FRAME_-99000_CLASS = 3\nFRAME_-99000_CLASS_ID = -99000\nFRAME_-99000_CENTER = -99\n"
    "CK_-99000_SCLK = -99\nCK_-99000_SPK = -99\n"
    "FRAME_TEST_FRAME = 1400099\nFRAME_1400099_NAME = 'TEST_FRAME'\nFRAME_1400099_CLASS = 4\n"
    "FRAME_1400099_CLASS_ID = 1400099\nFRAME_1400099_CENTER = -99\n"
    "TKFRAME_1400099_SPEC = 'ANGLES'\nTKFRAME_1400099_RELATIVE = 'TEST_CRAFT'\n"
    "TKFRAME_1400099_ANGLES = ( 90 )\nTKFRAME_1400099_ANGLES += ( 0, 0 )\n"
    "TKFRAME_1400099_AXES = ( 3, 2, 1 )\nTKFRAME_1400099_UNITS = 'DEGREES'\n"
    "NAIF_BODY_NAME += 'O''NEILL  ONE'\nNAIF_BODY_CODE += -99\n\\begintext\n";

// Attitude of even turns about z, 0.01 rad a tick: from 1000 to 1100 and from 1200 to 1250.
std::vector<double> turning(int type) {
  std::vector<double> out, times;
  const double rate = 0.005;  // rad/s, at 2 s a count of 10 ticks
  for (const double t : {1000.0, 1030.0, 1100.0, 1200.0, 1250.0}) {
    const double half = 0.5 * 0.001 * t;
    // a matrix of reference to instrument turns back
    out.insert(out.end(), {std::cos(half), 0, 0, -std::sin(half), 0, 0, rate});
    if (type == 2) out.push_back(0.2);
    times.push_back(t);
  }
  if (type == 2) {
    out.insert(out.end(), times.begin(), times.end());
    out.insert(out.end(), {1030, 1100, 1100, 1250, 1250});
    return out;
  }
  out.insert(out.end(), times.begin(), times.end());
  out.insert(out.end(), {1000, 1200, 2, 5});
  return out;
}

TEST(Kernels, AttitudesClocksAndFrames) {
  for (const int type : {2, 3}) {
    const Shelf shelf(
        {daf("DAF/CK", {{{-99000, 1, type, 1}, 1000, 1250, turning(type)}}), kClock, kFrames});
    const Kernels kernels = shelf.load();
    std::string problem;
    EXPECT_NEAR(*kernels.et_of_ticks(-99, 1050, problem), 110, 1e-12);
    EXPECT_NEAR(*kernels.ticks_of_et(-99, 110, problem), 1050, 1e-9);
    EXPECT_EQ(kernels.body("o'neill one"), -99);
    const int frame = *kernels.frame("test_craft");
    for (const double ticks : {1000.0, 1015.0, 1077.0, 1100.0, 1211.0}) {
      const double et = *kernels.et_of_ticks(-99, ticks, problem);
      const auto axes = kernels.attitude(frame, et, problem);
      ASSERT_TRUE(axes) << type << " " << ticks << " " << problem;
      // type 2 turns by its own rate, 0.001 rad a tick; x of the instrument in the reference
      const double angle = 0.001 * ticks;
      const Vec3 x(axes->from_j2000[0][0], axes->from_j2000[1][0], axes->from_j2000[2][0]);
      EXPECT_LE(length(x - Vec3(std::cos(angle), std::sin(angle), 0)), 1e-12) << type << ticks;
      EXPECT_EQ(axes->rate->z, 0.005);
      // v_craft = [90°]3 v_frame: x of the frame lies along −y of the craft
      const auto fixed = kernels.attitude(*kernels.frame("TEST_FRAME"), et, problem);
      const Vec3 other(fixed->from_j2000[0][0], fixed->from_j2000[1][0], fixed->from_j2000[2][0]);
      EXPECT_LE(length(other - Vec3(std::sin(angle), -std::cos(angle), 0)), 1e-12);
    }
    EXPECT_FALSE(kernels.attitude(frame, *kernels.et_of_ticks(-99, 1150, problem), problem));
    const auto spans = kernels.attitude_coverage(*kernels.frame("TEST_FRAME"));
    ASSERT_EQ(spans.size(), 2u) << type;
    EXPECT_NEAR(spans[0].end, *kernels.et_of_ticks(-99, 1100, problem), 1e-9);
    EXPECT_NEAR(spans[1].begin, *kernels.et_of_ticks(-99, 1200, problem), 1e-9);
  }
}

constexpr const char* kLeap =
    "KPL/LSK\n\\begindata\nDELTET/DELTA_T_A = 32.184\nDELTET/K = 1.657D-3\nDELTET/EB = 1.671D-2\n"
    "DELTET/M = ( 6.239996D0 1.99096871D-7 )\nDELTET/DELTA_AT = ( 32, @1999-JAN-1\n"
    "36, @2015-JUL-1 37, @2017-JAN-1 )\n\\begintext\n";

TEST(Kernels, LeapSeconds) {
  const Kernels kernels = Shelf({kLeap}).load();
  std::string problem;
  // 2000-01-01T12:00:00 UTC is 64.184 s of TT past J2000
  EXPECT_NEAR(*kernels.et_of_utc("2000-01-01T12:00:00", problem), 64.184, 1e-4);
  const double before = *kernels.et_of_utc("2016-12-31T23:59:59", problem);
  EXPECT_NEAR(*kernels.et_of_utc("2016-12-31T23:59:60", problem) - before, 1, 1e-7);
  EXPECT_NEAR(*kernels.et_of_utc("2017-01-01T00:00:00", problem) - before, 2, 1e-7);
  EXPECT_EQ(*kernels.utc_of_et(before, problem), "2016-12-31T23:59:59");
  EXPECT_FALSE(kernels.et_of_utc("yesterday", problem));
  EXPECT_FALSE(Shelf({kClock}).load().et_of_utc("2000-01-01T12:00:00", problem));
  EXPECT_NE(problem.find(".tls"), problem.npos);
}

// Poles and meridians, with sums in angles of degree 2.
TEST(Kernels, TextPck) {
  const Kernels kernels =
      Shelf({std::string(
                "KPL/PCK\n\\begindata\nBODY499_POLE_RA = ( 10 0 )\nBODY499_POLE_DEC = ( 60 )\n"
                "BODY499_PM = ( 5 1440 )\nBODY499_NUT_PREC_RA = ( 0 2.0 )\n"
                "BODY4_NUT_PREC_ANGLES = ( 1 0 0  30 0 3652500 )\nBODY4_MAX_PHASE_DEGREE = 2\n"
                "BODY499_RADII = ( 3396 3396 3376 )\n\\begintext\n")})
          .load();
  std::string problem;
  EXPECT_EQ(kernels.radii(499)->z, 3376);
  const double et = 86400.0 * 36525 * 0.001;  // 30 + 3.6525 degrees
  const auto axes = kernels.attitude(*kernels.frame("IAU_MARS"), et, problem);
  ASSERT_TRUE(axes) << problem;
  const double ra = (10 + 2 * std::sin(33.6525 * kDegree)) * kDegree, dec = 60 * kDegree;
  const Vec3 pole(axes->from_j2000[0][2], axes->from_j2000[1][2], axes->from_j2000[2][2]);
  EXPECT_LE(length(pole -
                   Vec3(std::cos(dec) * std::cos(ra), std::cos(dec) * std::sin(ra), std::sin(dec))),
            1e-14);
  // four turns a day; the pole moves too, 1.0e-9 rad/s
  EXPECT_NEAR(dot(*axes->rate, pole), 8 * kPi / 86400, 2e-9);
  const auto next = kernels.attitude(*kernels.frame("IAU_MARS"), et + 1, problem);
  const Vec3 x(axes->from_j2000[0][0], axes->from_j2000[1][0], axes->from_j2000[2][0]);
  const Vec3 moved(next->from_j2000[0][0], next->from_j2000[1][0], next->from_j2000[2][0]);
  EXPECT_LE(length((moved - x) - cross(*axes->rate, 0.5 * (x + moved))), 1e-9);
}

TEST(Kernels, Coverage) {
  Segment late = segment(2);
  late.begin = 400;
  late.end = 600;
  Segment early = segment(3);
  early.end = 150;
  const Shelf shelf({daf("DAF/SPK", {early, late})});
  const Kernels kernels = shelf.load();
  EXPECT_EQ(kernels.coverage(-99, 399, kJ2000), (std::vector<Interval>{{0, 150}, {400, 600}}));
  EXPECT_TRUE(kernels.coverage(-99, 301, kJ2000).empty());
}

TEST(Kernels, BadTextsHaveTheirLine) {
  for (const auto& [text, what] : std::vector<std::pair<std::string, std::string>>{
           {"KPL/FK\n\\begindata\nA = ( 1 2\n", "line 4: the end of"},
           {"KPL/FK\n\\begindata\n\nA = 'x\n", "line 4: a text"},
           {"KPL/FK\n\\begindata\nA = 1e\n", "line 3: '1e'"},
           {"KPL/FK\n\\begindata\nA 7\n", "line 3: expected ="},
           {"KPL/FK\n\\begindata\nA = ( 1 'b' )\n", "numbers and texts"}}) {
    DiagnosticLog log;
    EXPECT_FALSE(Shelf({text}).load(log));
    EXPECT_NE(to_text(log).find(what), std::string::npos) << to_text(log);
  }
}

// Kernels of all kinds, cut at 100 places and with other bytes at 400: refused or sound.
TEST(Kernels, Damaged) {
  std::vector<std::string> wholes{kFrames, kClock, kLeap};
  for (const int type : kTypes)
    wholes.push_back(daf("DAF/SPK", {segment(type), segment(2, 399, 0)},
                         type % 2 == 0 ? Order::little : Order::big));
  for (const int type : {2, 3})
    wholes.push_back(daf("DAF/CK", {{{-99000, 1, type, 1}, 1000, 1250, turning(type)}}));
  std::string broken;
  std::size_t loaded = 0, asked = 0;
  for (const std::string& whole : wholes) {
    EXPECT_TRUE(ask_all(whole, broken));
    for (std::size_t k = 0; k < 100; ++k)
      loaded += ask_all(whole.substr(0, whole.size() * k / 100), broken) ? 1 : 0, ++asked;
    std::uint64_t state = 1;
    for (std::size_t k = 0; k < 400; ++k) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      std::string bytes = whole;
      // half of them in the head and the summaries
      const std::size_t reach =
          k % 2 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 1200);
      bytes[(state >> 33) % reach] = static_cast<char>(state >> 20);
      loaded += ask_all(bytes, broken) ? 1 : 0, ++asked;
    }
    EXPECT_EQ(broken, "");
  }
  EXPECT_GT(loaded, asked / 4);
  EXPECT_LT(loaded, asked);
}

TEST(Kernels, MetaKernels) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "meta_kernels";
  std::filesystem::create_directories(folder / "data");
  DiagnosticLog log;
  EXPECT_TRUE(write_file(folder / "data" / "leap.tls", as_bytes(std::string(kLeap)), log));
  EXPECT_TRUE(write_file(folder / "all.tm",
                         as_bytes(std::string("KPL/MK\n\\begindata\nPATH_VALUES = ( 'data' )\n"
                                              "PATH_SYMBOLS = ( 'D' )\n"
                                              "KERNELS_TO_LOAD = ( '$D/leap+', '.tls' )\n")),
                         log));
  // a word in comments makes none
  EXPECT_TRUE(write_file(
      folder / "frames.tf",
      as_bytes("KPL/FK\nas in KERNELS_TO_LOAD = ( 'x' )\n" + std::string(kFrames).substr(7)), log));
  const std::vector<std::filesystem::path> paths{folder / "frames.tf", folder / "all.tm"};
  const auto kernels = Kernels::load(paths, log);
  ASSERT_TRUE(kernels) << to_text(log);
  std::string problem;
  EXPECT_TRUE(kernels->et_of_utc("2000-01-01T12:00:00", problem));
  EXPECT_TRUE(kernels->frame("TEST_FRAME"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace panwright::ephemeris::kernels_test
