// Orbit ephemeris messages: good and wrong texts by the rules of CCSDS 502.0-B.
#include "scenario/oem.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/scenario/support.h"

namespace panwright::scenario::oem_test {
namespace {

using support::at;
using support::codes;
using support::first_line;

const std::string kHeader =
    "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = TEST\n";
const std::string kMeta =
    "META_START\nOBJECT_NAME = CLIENT\nOBJECT_ID = 2026-001A\nCENTER_NAME = EARTH\n"
    "REF_FRAME = EME2000\nTIME_SYSTEM = UTC\nSTART_TIME = 2026-01-01T00:00:00\n"
    "STOP_TIME = 2026-01-01T00:10:00\n";
const std::string kMethod = "INTERPOLATION = HERMITE\nINTERPOLATION_DEGREE = 7\n";
const std::string kStates =
    "META_STOP\n"
    "2026-01-01T00:00:00 7000 0 0 0 7.5 0\n2026-01-01T00:01:00 7000 450 0 0 7.5 0\n"
    "2026-01-01T00:02:00 7000 900 0 0 7.5 0\n2026-01-01T00:03:00 7000 1350 0 0 7.5 0\n";

SourcePtr read(const std::string& text, const std::string& expected = "") {
  DiagnosticLog log;
  auto source = read_oem(memory_text("t.oem", text), {"client", false}, log);
  EXPECT_TRUE(source) << to_text(log);
  EXPECT_EQ(codes(log), expected) << to_text(log);
  return source ? *source : nullptr;
}

std::string problem(const std::string& text, bool strict = false) {
  DiagnosticLog log;
  auto source = read_oem(memory_text("t.oem", text), {"client", strict}, log);
  EXPECT_EQ(source.ok(), !log.has_errors());
  return codes(log) + ":" + std::to_string(first_line(log));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t found = text.find(from);
  EXPECT_NE(found, std::string::npos) << from;
  return text.replace(found, from.size(), to);
}

Vec3 position(const Source& source, double time) {
  return at(source, time).targets.at(0).placement.position.value_or(Vec3(0));
}

TEST(Oem, ReadsMetres) {
  const auto source = read(kHeader + kMeta + kMethod + kStates);
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().frame, "EME2000");
  EXPECT_EQ(source->info().centre, "EARTH");
  EXPECT_EQ(epoch_text(*source->info().epoch, TimeSystem::utc), "2026-01-01T00:00:00");
  EXPECT_EQ(source->info().times, (std::vector<double>{0, 60, 120, 180}));
  EXPECT_LT(length(position(*source, 90) - Vec3(7e6, 675e3, 0)), 1e-8);
  DiagnosticLog log;
  Frame frame;
  EXPECT_FALSE(source->at(180.001, frame, log));
  EXPECT_EQ(codes(log), "E8003");
  EXPECT_NE(to_text(log).find("2026-01-01T00:03:00"), std::string::npos) << to_text(log);
}

// The error of an ephemeris of a circular orbit: that of the methods, at steps of 60 s.
TEST(Oem, ErrorsOfMethods) {
  const double radius = 6778, rate = std::sqrt(398600.4418 / std::pow(radius, 3));
  const auto error = [&](const std::string& method) {
    std::string text = kHeader + kMeta + method + "META_STOP\n";
    for (int i = 0; i <= 20; ++i) {
      const double a = rate * 60 * i;
      text += fmt::format("2026-01-01T00:{:02}:00 {:.15e} {:.15e} 0 {:.15e} {:.15e} 0\n", i,
                          radius * std::cos(a), radius * std::sin(a), -radius * rate * std::sin(a),
                          radius * rate * std::cos(a));
    }
    DiagnosticLog log;
    const auto source = read_oem(memory_text("t.oem", text), {"client", false}, log);
    EXPECT_TRUE(source) << to_text(log);
    double worst = 0;
    for (int i = 5; i < 15; ++i) {
      const double t = 60 * i + 30, a = rate * t;
      worst = std::max(
          worst, length(position(**source, t) - 1000 * radius * Vec3(std::cos(a), std::sin(a), 0)));
    }
    return worst;
  };
  // closed form: r·(n·h/2)² / 2 …; 3.9e3, 0.37, 1.3e-4, 2.4e-8, 3.2e-3, 3.3e-6 m
  EXPECT_NEAR(error("INTERPOLATION = LINEAR\n"), 3.9e3, 100);
  EXPECT_NEAR(error("INTERPOLATION = HERMITE\nINTERPOLATION_DEGREE = 3\n"), 0.37, 0.05);
  EXPECT_NEAR(error("INTERPOLATION = Hermite\nINTERPOLATION_DEGREE = 5\n"), 1.3e-4, 0.8e-4);
  EXPECT_LT(error("INTERPOLATION = HERMITE\nINTERPOLATION_DEGREE = 7\n"), 4e-8);
  EXPECT_NEAR(error("INTERPOLATION = LAGRANGE\nINTERPOLATION_DEGREE = 5\n"), 3.2e-3, 4e-4);
  EXPECT_NEAR(error("INTERPOLATION = LAGRANGE\nINTERPOLATION_DEGREE = 7\n"), 3.3e-6, 5e-7);
}

TEST(Oem, UsableSpansAndSegments) {
  const std::string second = replaced(
      replaced(kMeta, "START_TIME = 2026-01-01T00:00:00", "START_TIME = 2026-01-01T00:05:00"),
      "STOP_TIME",
      "USEABLE_START_TIME = 2026-01-01T00:05:30\n"
      "USEABLE_STOP_TIME = 2026-01-01T00:06:00\n"
      "STOP_TIME");
  const auto source = read(kHeader + kMeta + kMethod + kStates + second +
                           "INTERPOLATION = LINEAR\nMETA_STOP\n"
                           "2026-01-01T00:05:00 1 0 0 0 0 0\n2026-01-01T00:06:00 3 0 0 0 0 0\n"
                           "2026-01-01T00:10:00 3 0 0 0 0 0\n");
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().spans, (std::vector<TimeSpan>{{0, 180}, {330, 360}}));
  EXPECT_LT(length(position(*source, 345) - Vec3(2500, 0, 0)), 1e-9);
  for (const double outside : {-1.0, 200.0, 329.0, 361.0}) {
    DiagnosticLog log;
    Frame frame;
    EXPECT_FALSE(source->at(outside, frame, log));
    EXPECT_EQ(codes(log), "E8003");
  }
  EXPECT_EQ(source->info().times, (std::vector<double>{0, 60, 120, 180, 360}));
}

// At the point that two blocks share, nothing of one enters the other.
TEST(Oem, NoInterpolationAcrossBlocks) {
  const std::string second =
      replaced(kMeta, "START_TIME = 2026-01-01T00:00:00", "START_TIME = 2026-01-01T00:03:00");
  const auto source =
      read(kHeader + kMeta + kMethod + kStates + second + "INTERPOLATION = LINEAR\nMETA_STOP\n" +
           "2026-01-01T00:03:00 7000 1350 0 0 0 0\n2026-01-01T00:04:00 7000 1350 60 0 0 1\n");
  ASSERT_TRUE(source);
  EXPECT_LT(length(position(*source, 179) - Vec3(7e6, 1342500, 0)), 1e-8);
  EXPECT_LT(length(position(*source, 181) - Vec3(7e6, 1350e3, 1000)), 1e-8);
}

TEST(Oem, ToleratedTexts) {
  const std::string good = kHeader + kMeta + kMethod + kStates;
  // CR LF, tabs, comments, day of year, Z, accelerations, covariances, versions 1 and 3
  std::string crlf;
  for (const char c : good) crlf += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_TRUE(read(crlf));
  EXPECT_TRUE(read(replaced(good, "META_STOP\n", "COMMENT a = b\nMETA_STOP\n\nCOMMENT\n")));
  EXPECT_TRUE(read(replaced(good, "2026-01-01T00:00:00 7000", "2026-001T00:00:00.000Z\t7000")));
  EXPECT_TRUE(read(replaced(good, "0 7.5 0\n", "0 7.5 0 1e-3 0.0D+00 +0\n")));
  EXPECT_TRUE(read(replaced(good, "= 2.0", "= 1.0")));
  EXPECT_TRUE(read(replaced(good, "= 2.0", "= 3.0\nMESSAGE_ID = 7\nCLASSIFICATION = none")));
  const std::string triangle = "1\n1 2\n1 2 3\n1 2 3 4\n1 2 3 4 5\n1 2 3 4 5 6\n";
  EXPECT_TRUE(read(good + "COVARIANCE_START\nEPOCH = 2026-01-01T00:00:00\nCOV_REF_FRAME = RTN\n" +
                   triangle + "EPOCH = 2026-01-01T00:01:00\n" + triangle + "COVARIANCE_STOP\n"));
  EXPECT_TRUE(read(kHeader + kMeta + kStates, "N8010"));
  EXPECT_TRUE(read(good + "2026-01-01T00:03:00 7000 1350 0 0 7.5 0\n", "W8012"));  // repeated
  EXPECT_TRUE(read(replaced(good, "DEGREE = 7", "DEGREE = 9"), "W8012"));
  EXPECT_TRUE(read(replaced(good, "OBJECT_ID = 2026-001A\n", ""), "W8012"));
  EXPECT_TRUE(
      read(replaced(good, "STOP_TIME = 2026-01-01T00:10:00", "STOP_TIME = 2026-01-01T00:02:00"),
           "W8012"));
  // J2000 is EME2000
  EXPECT_TRUE(read(good +
                       replaced(replaced(kMeta, "EME2000", "J2000"), "START_TIME",
                                "USEABLE_START_TIME = 2026-01-01T00:03:00\nSTART_TIME") +
                       kMethod +
                       "META_STOP\n2026-01-01T00:03:00 1 0 0 0 0 0\n"
                       "2026-01-01T00:04:00 1 0 0 0 0 0\n",
                   "W8012"));  // degree 7 of two records
  // two blocks that overlap: the first counts
  EXPECT_TRUE(read(good + kMeta + kMethod + kStates, "W8012"));
}

TEST(Oem, WrongTexts) {
  const std::string good = kHeader + kMeta + kMethod + kStates;
  EXPECT_EQ(problem(""), "E8001:1");
  EXPECT_EQ(problem("CREATION_DATE = 2026-01-01T00:00:00\n"), "E8001:1");
  EXPECT_EQ(problem(kHeader), "E8001:1");
  EXPECT_EQ(problem(replaced(good, "= 2.0", "= 4.0")), "E8001:1");
  EXPECT_EQ(problem(replaced(good, "META_STOP", "WRONG_KEYWORD = 123\nMETA_STOP")), "E8001:14");
  EXPECT_EQ(
      problem(replaced(good, "2026-01-01T00:01:00 7", "USER_KEY = bad\n2026-01-01T00:01:00 7")),
      "E8001:16");
  for (const std::string key :
       {"REF_FRAME = EME2000\n", "TIME_SYSTEM = UTC\n", "STOP_TIME = 2026-01-01T00:10:00\n",
        "START_TIME = 2026-01-01T00:00:00\n"})
    EXPECT_EQ(problem(replaced(good, key, "")), "E8001:4") << key;
  EXPECT_EQ(problem(replaced(good, "REF_FRAME", "REF_FRAME = X\nREF_FRAME")), "E8001:9");
  EXPECT_EQ(problem(replaced(good, "REF_FRAME = EME2000", "REF_FRAME =")), "E8001:8");
  EXPECT_EQ(problem(replaced(good, "INTERPOLATION_DEGREE = 7\n", "")), "E8001:12");
  EXPECT_EQ(problem(replaced(good, "DEGREE = 7", "DEGREE = 2.5")), "E8001:13");
  EXPECT_EQ(problem(replaced(good, "= HERMITE", "= SPLINE")), "E8001:12");
  EXPECT_EQ(problem(replaced(good, "7000 450 0", "7000 450")), "E8001:16");    // 5 numbers
  EXPECT_EQ(problem(replaced(good, "7000 450 0", "7000 45O 0")), "E8001:16");  // letter O
  EXPECT_EQ(problem(replaced(good, "7000 450 0", "7000 nan 0")), "E8001:16");
  EXPECT_EQ(problem(replaced(good, "T00:01:00 7000", "T00:61:00 7000")), "E8001:16");
  EXPECT_EQ(problem(replaced(good, "T00:02:00 7000", "T00:00:30 7000")), "E8004:17");
  EXPECT_EQ(problem(replaced(good, "T00:02:00 7000", "T00:01:00 7000")), "E8004:17");
  EXPECT_EQ(problem(replaced(good, "TIME_SYSTEM = UTC", "TIME_SYSTEM = UT1")), "E8007:9");
  EXPECT_EQ(
      problem(replaced(good, "STOP_TIME = 2026-01-01T00:10:00", "STOP_TIME = 2025-01-01T00:10:00")),
      "E8004:11");
  EXPECT_EQ(problem(kHeader + kMeta + kMethod + "META_STOP\n"), "E8001:4");  // no record
  EXPECT_EQ(problem(kHeader + kMeta + kMethod), "E8001:4");                  // not closed
  EXPECT_EQ(problem(good + "COVARIANCE_START\n1\nCOVARIANCE_STOP\n"), "E8001:20");
  EXPECT_EQ(problem(good + "COVARIANCE_START\nEPOCH = 2026-01-01T00:00:00\n1\n1 2 3\n"),
            "E8001 E8001:22");
  EXPECT_EQ(problem(good + replaced(kMeta, "= UTC", "= TAI") + kMethod + kStates), "E8007:24");
  EXPECT_EQ(problem(good + replaced(kMeta, "= CLIENT", "= OTHER") + kMethod + kStates), "E8001:20");
  EXPECT_EQ(problem(good +
                    replaced(kMeta, "STOP_TIME",
                             "USEABLE_START_TIME = 2026-01-01T00:02:30\n"
                             "USEABLE_STOP_TIME = 2026-01-01T00:02:00\nSTOP_TIME") +
                    kMethod + kStates),
            "E8004:19");
  EXPECT_EQ(problem(good + kMeta + kMethod + kStates, true), "E8001:19");
  EXPECT_EQ(problem(replaced(good, "OBJECT_ID = 2026-001A\n", ""), true), "E8001:4");
}

const std::string kXml =
    "<?xml version=\"1.0\"?>\n<oem id=\"CCSDS_OEM_VERS\" version=\"2.0\">\n"
    "<header><ORIGINATOR>T</ORIGINATOR></header><body><segment>\n<metadata><COMMENT>x</COMMENT>"
    "<OBJECT_NAME>A</OBJECT_NAME><OBJECT_ID>A</OBJECT_ID><CENTER_NAME>EARTH</CENTER_NAME>"
    "<REF_FRAME>J2000</REF_FRAME>\n<TIME_SYSTEM>UTC</TIME_SYSTEM>"
    "<START_TIME>2026-01-01T00:00:00</START_TIME><STOP_TIME>2026-01-01T00:01:00</STOP_TIME>"
    "<INTERPOLATION>LINEAR</INTERPOLATION></metadata>\n<data>\n"
    "<stateVector><EPOCH>\n 2026-01-01T00:00:00 </EPOCH><X units=\"km\">1</X><Y>2</Y><Z>3</Z>"
    "<X_DOT>0</X_DOT><Y_DOT>0</Y_DOT><Z_DOT>0</Z_DOT></stateVector>\n"
    "<stateVector><EPOCH>2026-01-01T00:01:00</EPOCH><X>3</X><Y>2</Y><Z>3</Z>"
    "<X_DOT>0</X_DOT><Y_DOT>0</Y_DOT><Z_DOT>0</Z_DOT></stateVector>\n"
    "</data></segment></body></oem>\n";

TEST(Oem, Xml) {
  const auto source = read(kXml);
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().frame, "EME2000");
  EXPECT_EQ(position(*source, 30), Vec3(2000, 2000, 3000));
  EXPECT_TRUE(read("<ndm>" + kXml.substr(kXml.find("<oem")) + "</ndm>"));
  EXPECT_EQ(problem(replaced(kXml, "</Y>", "</Z>")), "E8001:8");
  EXPECT_EQ(problem(replaced(kXml, "<oem", "<opm")).substr(0, 5), "E8001");
  EXPECT_EQ(problem(replaced(kXml, "<oem id=\"CCSDS_OEM_VERS\" version=\"2.0\"", "<oem")),
            "E8001:2");
  EXPECT_EQ(problem(replaced(kXml, "units=\"km\"", "units=\"m\"")), "E8001:8");
  EXPECT_EQ(problem(replaced(kXml, "<X>3</X>", "<X>three</X>")), "E8001:9");
  EXPECT_EQ(problem(replaced(kXml, "<X>3</X>", "")), "E8001:9");
  EXPECT_EQ(problem(replaced(kXml, "<X>3</X>", "<X>3</X><W>3</W>")), "E8001:9");
  EXPECT_EQ(problem(replaced(kXml, "<REF_FRAME>J2000</REF_FRAME>", "<WRONG>1</WRONG>")), "E8001:4");
  EXPECT_EQ(problem(replaced(kXml, "2026-01-01T00:01:00</EPOCH>", "2025-01-01T00:01:00</EPOCH>")),
            "E8004:9");
  EXPECT_EQ(problem("<oem version=\"1.0\"/>"), "E8001:1");
}

}  // namespace
}  // namespace panwright::scenario::oem_test
