// One attitude, written in the convention of each source, reads as one rotation: 90 degrees about
// (2, 3, 6)/7, where no axis and no sign is like another.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scenario/aem.h"
#include "scenario/csv.h"
#include "scenario/fli.h"
#include "scenario/keyframes.h"
#include "scenario/simulators.h"
#include "tests/scenario/support.h"

namespace panwright::scenario::attitudes_test {
namespace {

using support::at;
using support::codes;

// Quaternion of a passive matrix c = body_from_ref by the formula of aerospace texts (Wertz,
// 12-14): q4 = ½√(1 + trace), q1 = (c23 − c32)/4q4…, with v_body = C·v_ref.
struct Passive {
  double q1, q2, q3, q4;
};
Passive passive_quaternion(const double (&c)[3][3]) {
  const double q4 = 0.5 * std::sqrt(1 + c[0][0] + c[1][1] + c[2][2]);
  return {(c[1][2] - c[2][1]) / (4 * q4), (c[2][0] - c[0][2]) / (4 * q4),
          (c[0][1] - c[1][0]) / (4 * q4), q4};
}

struct Matrix {
  double m[3][3];  // world_from_body
};
Matrix asymmetric() {
  // Rodrigues' formula at 90 degrees: n nᵀ + [n]×
  const double n[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7};
  return {{{n[0] * n[0], n[0] * n[1] - n[2], n[0] * n[2] + n[1]},
           {n[1] * n[0] + n[2], n[1] * n[1], n[1] * n[2] - n[0]},
           {n[2] * n[0] - n[1], n[2] * n[1] + n[0], n[2] * n[2]}}};
}

// Angle by which a rotation read misses the truth, radians.
double miss(const std::optional<Quat>& q, const Matrix& truth) {
  if (!q) return 10;
  double worst = 0;
  for (int column = 0; column < 3; ++column) {
    const Vec3 axis(column == 0, column == 1, column == 2);
    const Vec3 turned = *q * axis;
    for (int row = 0; row < 3; ++row)
      worst = std::max(worst, std::abs(turned[row] - truth.m[row][column]));
  }
  return worst;
}

class Attitudes : public testing::Test {
 protected:
  Attitudes() : truth_(asymmetric()) {
    double body_from_world[3][3];
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) body_from_world[i][k] = truth_.m[k][i];
    p_ = passive_quaternion(body_from_world);
  }

  double aem(int version, const std::string& meta, const std::string& values) {
    const std::string text = fmt::format(
        "CCSDS_AEM_VERS = {}.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = T\n"
        "META_START\nOBJECT_NAME = A\nOBJECT_ID = A\nTIME_SYSTEM = TAI\n"
        "START_TIME = 2026-01-01T00:00:00\nSTOP_TIME = 2026-01-01T00:01:00\n{}META_STOP\n"
        "DATA_START\n2026-01-01T00:00:00 {}\nDATA_STOP\n",
        version, meta, values);
    DiagnosticLog log;
    const auto source = read_aem(memory_text("a.aem", text), {"a", false}, log);
    EXPECT_TRUE(source) << to_text(log);
    EXPECT_FALSE(log.has_errors() || log.warnings() > 0) << to_text(log);
    return source ? miss(at(**source, 0).targets.at(0).placement.rotation, truth_) : 10;
  }

  std::string first(const Passive& p) const {
    return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}", p.q4, p.q1, p.q2, p.q3);
  }
  std::string last(const Passive& p) const {
    return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}", p.q1, p.q2, p.q3, p.q4);
  }

  Matrix truth_;
  Passive p_;
};

TEST_F(Attitudes, Aem) {
  const Passive inverse{-p_.q1, -p_.q2, -p_.q3, p_.q4};
  const std::string to_body = "REF_FRAME_A = EME2000\nREF_FRAME_B = SC_BODY_1\n";
  const std::string from_body = "REF_FRAME_A = SC_BODY_1\nREF_FRAME_B = EME2000\n";
  const std::string type = "ATTITUDE_TYPE = QUATERNION\n";
  EXPECT_LT(
      aem(1, to_body + "ATTITUDE_DIR = A2B\n" + type + "QUATERNION_TYPE = FIRST\n", first(p_)),
      1e-15);
  EXPECT_LT(aem(1, to_body + "ATTITUDE_DIR = A2B\n" + type + "QUATERNION_TYPE = LAST\n", last(p_)),
            1e-15);
  EXPECT_LT(
      aem(1, to_body + "ATTITUDE_DIR = B2A\n" + type + "QUATERNION_TYPE = LAST\n", last(inverse)),
      1e-15);
  EXPECT_LT(
      aem(1, from_body + "ATTITUDE_DIR = B2A\n" + type + "QUATERNION_TYPE = LAST\n", last(p_)),
      1e-15);
  EXPECT_LT(aem(1, from_body + "ATTITUDE_DIR = A2B\n" + type + "QUATERNION_TYPE = FIRST\n",
                first(inverse)),
            1e-15);
  EXPECT_LT(aem(2, to_body + type, last(p_)), 1e-15);
  EXPECT_LT(aem(2, from_body + type, last(inverse)), 1e-15);
  // with rates, which are not used
  EXPECT_LT(aem(2, to_body + "ATTITUDE_TYPE = QUATERNION/ANGVEL\nANGVEL_FRAME = SC_BODY_1\n",
                last(p_) + " 0.1 0.2 0.3"),
            1e-15);
  EXPECT_LT(aem(2, to_body + "ATTITUDE_TYPE = QUATERNION/DERIVATIVE\n", last(p_) + " 1 2 3 4"),
            1e-15);
}

TEST_F(Attitudes, AemXml) {
  const auto xml = [&](const std::string& type, const std::string& more, const std::string& state) {
    const std::string text =
        "<aem version=\"1.0\"><body><segment><metadata><OBJECT_NAME>A</OBJECT_NAME>"
        "<OBJECT_ID>A</OBJECT_ID><REF_FRAME_A>EME2000</REF_FRAME_A>"
        "<REF_FRAME_B>SC_BODY_1</REF_FRAME_B><ATTITUDE_DIR>A2B</ATTITUDE_DIR>"
        "<TIME_SYSTEM>UTC</TIME_SYSTEM><START_TIME>2026-01-01T00:00:00</START_TIME>"
        "<STOP_TIME>2026-01-01T00:01:00</STOP_TIME><ATTITUDE_TYPE>" +
        type + "</ATTITUDE_TYPE>" + more + "</metadata><data><attitudeState>" + state +
        "</attitudeState></data></segment></body></aem>";
    DiagnosticLog log;
    const auto source = read_aem(memory_text("a.xml", text), {"a", false}, log);
    EXPECT_TRUE(source) << to_text(log);
    return source ? miss(at(**source, 0).targets.at(0).placement.rotation, truth_) : 10;
  };
  const std::string q =
      fmt::format("<QC>{:.17g}</QC><Q1>{:.17g}</Q1><Q2>{:.17g}</Q2><Q3>{:.17g}</Q3>", p_.q4, p_.q1,
                  p_.q2, p_.q3);
  const std::string epoch = "<EPOCH>2026-01-01T00:00:00</EPOCH>";
  EXPECT_LT(
      xml("QUATERNION", "<QUATERNION_TYPE>FIRST</QUATERNION_TYPE>",
          "<quaternionState>" + epoch + "<quaternion>" + q + "</quaternion></quaternionState>"),
      1e-15);
  EXPECT_LT(xml("QUATERNION", "", "<quaternionEphemeris>" + epoch + q + "</quaternionEphemeris>"),
            1e-15);
  EXPECT_LT(xml("QUATERNION/DERIVATIVE", "<QUATERNION_TYPE>LAST</QUATERNION_TYPE>",
                "<quaternionDerivative>" + epoch + "<quaternion>" + q +
                    "</quaternion><quaternionRate><QC_DOT>1</QC_DOT></quaternionRate></"
                    "quaternionDerivative>"),
            1e-15);
  const auto& m = truth_.m;
  const double deg = 180 / M_PI;
  EXPECT_LT(
      xml("EULER_ANGLE", "<EULER_ROT_SEQ>312</EULER_ROT_SEQ>",
          fmt::format("<eulerAngle>{}<rotationAngles><rotation1 units=\"deg\">{:.17g}</rotation1>"
                      "<rotation2>{:.17g}</rotation2><rotation3>{:.17g}</rotation3>"
                      "</rotationAngles></eulerAngle>",
                      epoch, std::atan2(-m[0][1], m[1][1]) * deg, std::asin(m[2][1]) * deg,
                      std::atan2(-m[2][0], m[2][2]) * deg)),
      4e-15);
}

// Euler angles of a product of passive matrices, solved by hand for 3-1-2 and Z-X-Z.
TEST_F(Attitudes, AemEulerAngles) {
  const auto& m = truth_.m;  // body_from_world is its transpose: c[i][k] = m[k][i]
  // C = R2(c)·R1(b)·R3(a): c[1][2] = sin b, c[1][0] = −sin a cos b, c[1][1] = cos a cos b,
  // c[0][2] = −sin c cos b, c[2][2] = cos c cos b
  const double deg = 180 / M_PI;
  const double b = std::asin(m[2][1]) * deg;
  const double a = std::atan2(-m[0][1], m[1][1]) * deg;
  const double c = std::atan2(-m[2][0], m[2][2]) * deg;
  const std::string to_body = "REF_FRAME_A = EME2000\nREF_FRAME_B = SC_BODY_1\n";
  EXPECT_LT(
      aem(1, to_body + "ATTITUDE_DIR = A2B\nATTITUDE_TYPE = EULER_ANGLE\nEULER_ROT_SEQ = 312\n",
          fmt::format("{:.17g} {:.17g} {:.17g}", a, b, c)),
      4e-15);
  // C = R3(g)·R1(b)·R3(a): c[2][2] = cos b, c[2][0] = sin a sin b, c[2][1] = −cos a sin b,
  // c[0][2] = sin g sin b, c[1][2] = cos g sin b
  const double b2 = std::acos(m[2][2]) * deg;
  const double a2 = std::atan2(m[0][2], -m[1][2]) * deg;
  const double g2 = std::atan2(m[2][0], m[2][1]) * deg;
  EXPECT_LT(aem(2,
                to_body + "ATTITUDE_TYPE = EULER_ANGLE/ANGVEL\nEULER_ROT_SEQ = ZXZ\n"
                          "ANGVEL_FRAME = SC_BODY_1\n",
                fmt::format("{:.17g} {:.17g} {:.17g} 0 0 0", a2, b2, g2)),
            4e-15);
}

TEST_F(Attitudes, Simulators) {
  DiagnosticLog log;
  const auto forty_two = read_42({memory_text("time.42", "0\n1\n"), std::nullopt,
                                  memory_text("qbn.42", last(p_) + "\n" + last(p_) + "\n"), "a"},
                                 log);
  ASSERT_TRUE(forty_two) << to_text(log);
  EXPECT_LT(miss(at(**forty_two, 0.5).targets.at(0).placement.rotation, truth_), 1e-15);
  // modified Rodrigues parameters of the passive matrix: q / (1 + q4), and the shadow set
  for (const double sign : {1.0, -1.0}) {
    const double scale = sign / (1 + sign * p_.q4);
    const auto basilisk = read_basilisk(
        memory_text("b.csv",
                    fmt::format("time[s],sigma_BN[0],sigma_BN[1],sigma_BN[2]\n"
                                "0,{0:.17g},{1:.17g},{2:.17g}\n1,{0:.17g},{1:.17g},{2:.17g}\n",
                                p_.q1 * scale, p_.q2 * scale, p_.q3 * scale)),
        "a", log);
    ASSERT_TRUE(basilisk) << to_text(log);
    EXPECT_LT(miss(at(**basilisk, 0.5).targets.at(0).placement.rotation, truth_), 2e-15);
  }
  EXPECT_EQ(codes(log), "");
}

// PANGU's and ours: Hamilton, scalar first, world_from_camera and world_from_model.
TEST_F(Attitudes, HamiltonQuaternions) {
  DiagnosticLog log;
  const std::string q = first(p_);
  const auto flight = read_fli(
      memory_text("f.fli", "dynamic_object 3 1 2 3 " + q + "\nquaternion 4 5 6 " + q + "\n"), {},
      log);
  ASSERT_TRUE(flight) << to_text(log);
  Frame frame;
  EXPECT_TRUE((*flight)->frame(0, frame, log));
  EXPECT_LT(miss(frame.camera.rotation, truth_), 1e-15);
  EXPECT_LT(miss(frame.targets.at(0).placement.rotation, truth_), 1e-15);
  std::string commas = q;
  for (char& c : commas)
    if (c == ' ') c = ',';
  const auto keys = read_keyframes(
      memory_text("k.json", "{\"keyframes\": [{\"time\": 0, \"camera\": [0,0,0], \"quat\": [" +
                                commas + "], \"pose\": {\"a\": [0,0,0," + commas + "]}}]}"),
      {}, log);
  ASSERT_TRUE(keys) << to_text(log);
  EXPECT_LT(miss(at(**keys, 0).camera.rotation, truth_), 1e-15);
  EXPECT_LT(miss(at(**keys, 0).targets.at(0).placement.rotation, truth_), 1e-15);
  const std::string head =
      "camera.qw[world_from_camera],camera.qx[world_from_camera],camera.qy[world_from_camera],"
      "camera.qz[world_from_camera]\n";
  const auto table = read_csv(memory_text("t.csv", head + commas + "\n"), {}, log);
  ASSERT_TRUE(table) << to_text(log);
  Frame row;
  EXPECT_TRUE((*table)->frame(0, row, log));
  EXPECT_LT(miss(row.camera.rotation, truth_), 1e-15);
}

// The angles of `start` by the matrix Rz(yaw)·Rx(pitch)·Rx(−90)·Rz(−roll), multiplied here.
TEST_F(Attitudes, AnglesOfFlights) {
  const double yaw = 30 * kDegree, pitch = -50 * kDegree, roll = 20 * kDegree;
  const auto times = [](const Matrix& a, const Matrix& b) {
    Matrix out{};
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) out.m[i][k] += a.m[i][l] * b.m[l][k];
    return out;
  };
  const auto rx = [](double t) {
    return Matrix{{{1, 0, 0}, {0, std::cos(t), -std::sin(t)}, {0, std::sin(t), std::cos(t)}}};
  };
  const auto rz = [](double t) {
    return Matrix{{{std::cos(t), -std::sin(t), 0}, {std::sin(t), std::cos(t), 0}, {0, 0, 1}}};
  };
  const Matrix truth = times(times(times(rz(yaw), rx(pitch)), rx(-kPi / 2)), rz(-roll));
  DiagnosticLog log;
  const auto flight = read_fli(memory_text("f.fli", "start 0 0 0 30 -50 20\n"), {}, log);
  ASSERT_TRUE(flight) << to_text(log);
  Frame frame;
  EXPECT_TRUE((*flight)->frame(0, frame, log));
  EXPECT_LT(miss(frame.camera.rotation, truth), 1e-15);
}

}  // namespace
}  // namespace panwright::scenario::attitudes_test
