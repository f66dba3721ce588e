// Attitude ephemeris messages: good and wrong texts by the rules of CCSDS 504.0-B.
#include "scenario/aem.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/scenario/support.h"

namespace panwright::scenario::aem_test {
namespace {

using support::at;
using support::codes;
using support::first_line;
using support::turn_between;

const std::string kFirst =
    "CCSDS_AEM_VERS = 1.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = TEST\n\n"
    "META_START\nOBJECT_NAME = CLIENT\nOBJECT_ID = 2026-001A\nREF_FRAME_A = EME2000\n"
    "REF_FRAME_B = SC_BODY_1\nATTITUDE_DIR = A2B\nTIME_SYSTEM = UTC\n"
    "START_TIME = 2026-01-01T00:00:00\nSTOP_TIME = 2026-01-01T00:02:00\n"
    "ATTITUDE_TYPE = QUATERNION\nQUATERNION_TYPE = LAST\nMETA_STOP\nDATA_START\n";
const std::string kRecords =
    "2026-01-01T00:00:00 0 0 0 1\n2026-01-01T00:01:00 0 0 0.5 0.8660254037844386\n"
    "2026-01-01T00:02:00 0 0 -0.8660254037844386 -0.5\nDATA_STOP\n";
const std::string kGood = kFirst + kRecords;

std::string problem(const std::string& text, bool strict = false) {
  DiagnosticLog log;
  const auto source = read_aem(memory_text("t.aem", text), {"client", strict}, log);
  EXPECT_EQ(source.ok(), !log.has_errors());
  return codes(log) + ":" + std::to_string(first_line(log));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t found = text.find(from);
  EXPECT_NE(found, std::string::npos) << from;
  return text.replace(found, from.size(), to);
}

// 60 degrees a minute about z; the third quaternion has the other sign.
TEST(Aem, TurnsTheShorterWay) {
  DiagnosticLog log;
  const auto source = read_aem(memory_text("t.aem", kGood), {"client", false}, log);
  ASSERT_TRUE(source) << to_text(log);
  EXPECT_EQ(codes(log), "");
  for (const double time : {0.0, 15.0, 60.0, 75.0, 90.0, 120.0}) {
    const double half = time * kDegree / 2;
    EXPECT_LT(turn_between(*at(**source, time).targets.at(0).placement.rotation,
                           Quat(std::cos(half), 0, 0, std::sin(half))),
              1.5e-15)
        << time;
  }
  EXPECT_EQ((*source)->info().frame, "EME2000");
  Frame frame;
  EXPECT_FALSE((*source)->at(-1, frame, log));
}

// Components of an even spin by a cubic: their error of order 4 lies along the quaternion, and that
// of the direction falls with the fifth power of the step.
TEST(Aem, LagrangeOfComponents) {
  const auto error = [](double degrees) {
    std::string text =
        replaced(kFirst, "META_STOP",
                 "INTERPOLATION_METHOD = LAGRANGE\nINTERPOLATION_DEGREE = 3\nMETA_STOP");
    for (int i = 0; i < 12; ++i) {
      const double half = i * degrees * kDegree / 2;
      text += fmt::format("2026-01-01T00:00:{:02} 0 0 {:.17g} {:.17g}\n", i, std::sin(half),
                          std::cos(half));
    }
    DiagnosticLog log;
    const auto source =
        read_aem(memory_text("t.aem", text + "DATA_STOP\n"), {"client", false}, log);
    EXPECT_TRUE(source) << to_text(log);
    const double half = 5.2 * degrees * kDegree / 2;
    return turn_between(*at(**source, 5.2).targets.at(0).placement.rotation,
                        Quat(std::cos(half), 0, 0, std::sin(half)));
  };
  EXPECT_NEAR(error(30) / error(15), 32, 4);
  EXPECT_LT(error(30), 1e-3);
  EXPECT_GT(error(30), 1e-6);
}

TEST(Aem, ToleratedTexts) {
  EXPECT_EQ(
      problem(replaced(kGood, "META_STOP",
                       "INTERPOLATION_METHOD = HERMITE\nINTERPOLATION_DEGREE = 7\nMETA_STOP")),
      "W8012:16");
  EXPECT_EQ(problem(replaced(kGood, "META_STOP", "INTERPOLATION_METHOD = linear\nMETA_STOP")),
            ":0");
  EXPECT_EQ(problem(replaced(kGood, "SC_BODY_1", "PLATFORM")), ":0");  // EME2000 is no body
  EXPECT_EQ(problem(replaced(replaced(kGood, "SC_BODY_1", "PLATFORM"), "EME2000", "HOME")),
            "W8012:9");
  EXPECT_EQ(problem(replaced(kGood, "0 0 0.5 0.8660254037844386", "0 0 0.5 0.86603")), ":0");
  EXPECT_EQ(problem(replaced(kGood, "0 0 0.5 0.8660254037844386", "0 0 0.5 0.85")), "W8006:19");
  // a block of spin is skipped, and the others are read
  const std::string block = kGood.substr(kGood.find("META_START"));
  EXPECT_EQ(problem(kGood + replaced(block, "= QUATERNION\n", "= SPIN/NUTATION\n")), "W8002:31");
  EXPECT_EQ(problem(kGood + block), "W8012:22");  // the same span again
  EXPECT_EQ(problem(kGood + block, true), "E8001:22");
}

TEST(Aem, WrongTexts) {
  EXPECT_EQ(problem(replaced(kGood, "= 1.0", "= 3.0")), "E8001:1");
  EXPECT_EQ(problem(replaced(kGood, "AEM", "OEM")), "E8001:1");
  EXPECT_EQ(problem(replaced(kGood, "= A2B", "= A2C")), "E8001:10");
  EXPECT_EQ(problem(replaced(kGood, "ATTITUDE_DIR = A2B\n", "")), "E8001:5");
  EXPECT_EQ(problem(replaced(kGood, "= LAST", "= MIDDLE")), "E8001:15");
  EXPECT_EQ(problem(replaced(kGood, "QUATERNION_TYPE = LAST\n", "")), "E8001:5");
  EXPECT_EQ(problem(replaced(kGood, "REF_FRAME_B = SC_BODY_1\n", "")), "E8001:5");
  EXPECT_EQ(problem(replaced(kGood, "= QUATERNION\n", "= DCM\n")), "E8001:14");
  EXPECT_EQ(problem(replaced(kGood, "= QUATERNION\n", "= QUATERNION/ANGVEL/RATE\n")), "E8001:14");
  EXPECT_EQ(problem(replaced(kGood, "= QUATERNION\n", "= SPIN\n")), "W8002 E8001:14");
  EXPECT_EQ(problem(replaced(kGood, "META_STOP", "SPURIOUS = 1\nMETA_STOP")), "E8001:16");
  EXPECT_EQ(problem(replaced(kGood, "META_STOP", "ANGVEL_FRAME = SC_BODY_1\nMETA_STOP")),
            "E8001:16");
  EXPECT_EQ(problem(replaced(kGood, "DATA_START\n", "")).substr(0, 5), "E8001");
  EXPECT_EQ(problem(replaced(kGood, "DATA_STOP\n", "")), "E8001:17");
  EXPECT_EQ(problem(replaced(kGood, "DATA_START\n", "DATA_START\nKEY = 1\n")), "E8001:18");
  EXPECT_EQ(problem(replaced(kGood, "0 0 0 1", "0 0 0")), "E8001:18");
  EXPECT_EQ(problem(replaced(kGood, "0 0 0 1", "0 0 0 1 0")), "E8001:18");
  EXPECT_EQ(problem(replaced(kGood, "0 0 0 1", "0 0 0 nan")), "E8001:18");
  EXPECT_EQ(problem(replaced(kGood, "0 0 0 1", "0 0 0 0")), "E8005:18");
  EXPECT_EQ(problem(replaced(kGood, "T00:01:00 ", "T00:00:00 ")), "E8004:19");
  EXPECT_EQ(problem(replaced(kGood, "= UTC", "= SCLK")), "E8007:11");
  // version 2 has neither of the two
  const std::string second = replaced(kGood, "= 1.0", "= 2.0");
  EXPECT_EQ(problem(second), "E8001 E8001:10");
  EXPECT_EQ(problem(replaced(second, "ATTITUDE_DIR = A2B\n", "")), "E8001:14");
  EXPECT_EQ(problem(replaced(replaced(second, "ATTITUDE_DIR = A2B\n", ""),
                             "QUATERNION_TYPE = LAST\n", "")),
            ":0");
  const std::string angles = replaced(replaced(kFirst, "= QUATERNION\n", "= EULER_ANGLE\n"),
                                      "QUATERNION_TYPE = LAST\n", "EULER_ROT_SEQ = 123\n") +
                             "2026-01-01T00:00:00 1 2 3\nDATA_STOP\n";
  EXPECT_EQ(problem(angles), ":0");
  EXPECT_EQ(problem(replaced(angles, "= 123", "= 312")), "N8010:15");
  for (const std::string wrong : {"7051995", "112", "12", "ABC"})
    EXPECT_EQ(problem(replaced(angles, "= 123", "= " + wrong)), "E8001:15") << wrong;
}

}  // namespace
}  // namespace panwright::scenario::aem_test
