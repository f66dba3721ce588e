// Analytic motions against integrated equations, Kepler's equation and conserved quantities.
#include "scenario/formulas.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "tests/scenario/support.h"

namespace panwright::scenario::formulas_test {
namespace {

using support::at;
using support::codes;
using Long = long double;
using State6 = std::array<Long, 6>;

// Runge and Kutta's method of order 4 in long double.
State6 integrated(const std::function<State6(const State6&)>& rates, State6 y, Long seconds,
                  int steps) {
  const Long h = seconds / steps;
  const auto moved = [](const State6& a, const State6& b, Long s) {
    State6 out;
    for (int i = 0; i < 6; ++i) out[i] = a[i] + s * b[i];
    return out;
  };
  for (int n = 0; n < steps; ++n) {
    const State6 k1 = rates(y), k2 = rates(moved(y, k1, h / 2)), k3 = rates(moved(y, k2, h / 2)),
                 k4 = rates(moved(y, k3, h));
    for (int i = 0; i < 6; ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  }
  return y;
}

State6 state6(const OrbitState& s) {
  return {s.position.x, s.position.y, s.position.z, s.velocity.x, s.velocity.y, s.velocity.z};
}

double off(const OrbitState& a, const State6& b) {
  double out = 0;
  for (int i = 0; i < 3; ++i)
    out = std::max(out, std::abs(static_cast<double>(a.position[i] - b[i])));
  return out;
}

constexpr double kRate = 0.00113;  // rad/s, low orbits of the Earth
const OrbitState kStart{{120, -340, 55}, {0.05, -0.11, 0.2}};

TEST(ClohessyWiltshire, SolvesItsEquation) {
  const auto rates = [](const State6& y) {
    const Long n = kRate;
    return State6{y[3], y[4], y[5], 3 * n * n * y[0] + 2 * n * y[4], -2 * n * y[3], -n * n * y[2]};
  };
  for (const double t : {1.0, 700.0, 5560.0, -900.0}) {
    const OrbitState out = clohessy_wiltshire(kStart, kRate, t);
    const State6 truth = integrated(rates, state6(kStart), t, 4000);
    EXPECT_LT(off(out, truth), 1e-9) << t;  // 3e-11 measured
    EXPECT_LT(std::abs(out.velocity.y - static_cast<double>(truth[4])), 1e-12) << t;
  }
}

TEST(ClohessyWiltshire, StepsCompose) {
  const OrbitState halfway = clohessy_wiltshire(kStart, kRate, 1234.5);
  const OrbitState two = clohessy_wiltshire(halfway, kRate, 2765.5);
  EXPECT_LT(off(two, state6(clohessy_wiltshire(kStart, kRate, 4000))), 2e-12);
}

TEST(ClohessyWiltshire, KnownMotions) {
  const double period = 2 * kPi / kRate;
  // without drift a closed ellipse of 2:1 about the origin
  const OrbitState closed{{100, 0, 0}, {0, -2 * kRate * 100, 0}};
  EXPECT_LT(length(clohessy_wiltshire(closed, kRate, period).position - closed.position), 1e-10);
  EXPECT_LT(length(clohessy_wiltshire(closed, kRate, period / 4).position - Vec3(0, -200, 0)),
            1e-10);
  // a V-bar hold stays
  const OrbitState hold{{0, -150, 0}, {0, 0, 0}};
  EXPECT_EQ(clohessy_wiltshire(hold, kRate, 3000).position, hold.position);
  // small times: free motion, without cancellation; accelerations of 1e-9 m/s²
  EXPECT_LT(length(clohessy_wiltshire(kStart, kRate, 1e-3).position -
                   (kStart.position + 1e-3 * kStart.velocity)),
            1e-9);
}

constexpr double kEarth = 3.986004418e14;

// A point of an ellipse by Kepler's equation.
OrbitState ellipse(double a, double e, double seconds) {
  const Long n = std::sqrt(static_cast<Long>(kEarth) / (static_cast<Long>(a) * a * a));
  const Long mean = n * seconds;
  Long anomaly = mean;
  for (int i = 0; i < 100; ++i)
    anomaly -= (anomaly - e * std::sin(anomaly) - mean) / (1 - e * std::cos(anomaly));
  const Long b = a * std::sqrt(1 - static_cast<Long>(e) * e);
  const Long rate = n / (1 - e * std::cos(anomaly));
  return {{static_cast<double>(a * (std::cos(anomaly) - e)),
           static_cast<double>(b * std::sin(anomaly)), 0},
          {static_cast<double>(-a * std::sin(anomaly) * rate),
           static_cast<double>(b * std::cos(anomaly) * rate), 0}};
}

TEST(TwoBody, EllipsesByKeplersEquation) {
  const double a = 7e6;
  for (const double e : {0.0, 0.01, 0.3, 0.9}) {
    const OrbitState start = ellipse(a, e, 0);
    for (const double t : {1e-3, 10.0, 1000.0, 2914.0, 5000.0, 58283.0, -700.0}) {
      const auto out = two_body(start, kEarth, t);
      ASSERT_TRUE(out);
      const OrbitState truth = ellipse(a, e, t);
      // rounding of the period shows at pericentre, after ten revolutions with e = 0.9: 2e-8 m/s
      EXPECT_LT(length(out->position - truth.position), 2e-6) << e << " " << t;
      EXPECT_LT(length(out->velocity - truth.velocity), 1e-7) << e << " " << t;
    }
  }
}

TEST(TwoBody, HyperbolasByTheirEquation) {
  const double a = 1e7, e = 1.6;
  const Long n = std::sqrt(static_cast<Long>(kEarth) / (static_cast<Long>(a) * a * a));
  const auto point = [&](Long h) {
    return Vec3(static_cast<double>(a * (e - std::cosh(h))),
                static_cast<double>(a * std::sqrt(static_cast<Long>(e) * e - 1) * std::sinh(h)), 0);
  };
  const double speed = std::sqrt(kEarth * (1 + e) / (a * (e - 1)));
  const OrbitState start{{a * (e - 1), 0, 0}, {0, speed, 0}};
  for (const Long h : {0.1L, 1.0L, 3.0L, 9.0L, -2.0L}) {
    const auto seconds = static_cast<double>((e * std::sinh(h) - h) / n);
    const auto out = two_body(start, kEarth, seconds);
    ASSERT_TRUE(out);
    EXPECT_LT(length(out->position - point(h)), 1e-13 * length(point(h)) + 1e-7)
        << static_cast<double>(h);
  }
}

// Barker's equation of parabolas: t = √(2 q³/mu)·(D + D³/3), D = tan(ν/2).
TEST(TwoBody, Parabolas) {
  const double q = 8e6;
  const OrbitState start{{q, 0, 0}, {0, std::sqrt(2 * kEarth / q), 0}};
  for (const double d : {0.01, 0.7, 2.0, 30.0}) {
    const double seconds = std::sqrt(2 * q * q * q / kEarth) * (d + d * d * d / 3);
    const auto out = two_body(start, kEarth, seconds);
    ASSERT_TRUE(out);
    const Vec3 truth(q * (1 - d * d), 2 * q * d, 0);
    EXPECT_LT(length(out->position - truth), 1e-10 * length(truth)) << d;
  }
}

TEST(TwoBody, ConservesEnergyAndMomentum) {
  const OrbitState start{{6.8e6, 1e6, -2e6}, {-1500, 6900, 2800}};
  const auto energy = [](const OrbitState& s) {
    return dot(s.velocity, s.velocity) / 2 - kEarth / length(s.position);
  };
  for (double t = -20000; t <= 20000; t += 1313) {
    const auto out = two_body(start, kEarth, t);
    ASSERT_TRUE(out);
    EXPECT_NEAR(energy(*out) / energy(start), 1, 1e-13);
    EXPECT_LT(length(cross(out->position, out->velocity) - cross(start.position, start.velocity)),
              1e-13 * length(cross(start.position, start.velocity)));
  }
}

TEST(TwoBody, StraightLines) {
  // free fall from rest at r: t = √(r³/2mu)·(acos √x + √(x (1 − x))) at x·r
  const double r = 1e7, x = 0.3;
  const double t =
      std::sqrt(r * r * r / (2 * kEarth)) * (std::acos(std::sqrt(x)) + std::sqrt(x * (1 - x)));
  const auto out = two_body({{r, 0, 0}, {0, 0, 0}}, kEarth, t);
  ASSERT_TRUE(out);
  EXPECT_NEAR(out->position.x, x * r, 1e-6);
  EXPECT_FALSE(two_body({{0, 0, 0}, {1, 0, 0}}, kEarth, 1));
  DiagnosticLog log;
  EXPECT_FALSE(two_body_source("a", {{r, 0, 0}, {0, 0, 0}}, kEarth, {0, 1e5}, {}, log));
  EXPECT_EQ(codes(log), "E8003");
}

// The error of the linear motion grows with the square of the distance: 2.8 cm in one orbit at
// 100 m along the track, and 2.8 m at 1 km, against the difference of two orbits.
TEST(ClohessyWiltshire, ErrorAgainstTwoBodies) {
  const double radius = 6778e3, rate = std::sqrt(kEarth / (radius * radius * radius));
  const auto error = [&](double distance) {
    const OrbitState chief{{radius, 0, 0}, {0, radius * rate, 0}};
    // a point beside the chief's place at rest in the rotating frame
    const OrbitState other{{radius, distance, 0}, {-rate * distance, radius * rate, 0}};
    double worst = 0;
    const double period = 2 * kPi / rate;
    for (int i = 1; i <= 40; ++i) {
      const double t = period * i / 40;
      const Vec3 apart =
          two_body(other, kEarth, t)->position - two_body(chief, kEarth, t)->position;
      const double c = std::cos(rate * t), s = std::sin(rate * t);
      const Vec3 seen(apart.x * c + apart.y * s, -apart.x * s + apart.y * c, apart.z);
      worst = std::max(worst,
                       length(seen - clohessy_wiltshire({{0, distance, 0}, {}}, rate, t).position));
    }
    return worst;
  };
  EXPECT_NEAR(error(100), 0.028, 0.003);
  EXPECT_NEAR(error(1000), 2.8, 0.3);
}

TEST(Formulas, Sources) {
  DiagnosticLog log;
  EXPECT_EQ(at(*clohessy_wiltshire_source("", kStart, kRate), 0).camera.position, kStart.position);
  const auto spin = spin_source("a", Quat(1, 0, 0, 0), Vec3(0, 0, kPi / 2));
  EXPECT_LT(length(*at(*spin, 1).targets.at(0).placement.rotation * Vec3(1, 0, 0) - Vec3(0, 1, 0)),
            1e-15);
  Frame fixed;
  fixed.camera.position = Vec3(1, 2, 3);
  fixed.target("b").placement.rotation = Quat(0, 1, 0, 0);
  fixed.joint("b", "wing") = {"wing", {0.5}, 1};
  fixed.sun_direction = Vec3(0, 0, 1);
  const auto source = fixed_source("fixed", fixed);
  EXPECT_EQ(source->info().channels.size(), 4u);
  EXPECT_EQ(at(*source, 1e9).joint("b", "wing").values[0], 0.5);
}

TEST(Formulas, HoldPoints) {
  DiagnosticLog log;
  const auto source = hold_point_source(
      "", {{0, 60, {0, -200, 0}}, {160, 200, {0, -20, 0}}, {220, 220, {0, -2, 0}}}, log);
  ASSERT_TRUE(source) << to_text(log);
  EXPECT_EQ((*source)->info().times, (std::vector<double>{0, 60, 160, 200, 220}));
  EXPECT_EQ(at(**source, 30).camera.position, Vec3(0, -200, 0));
  EXPECT_EQ(at(**source, 110).camera.position, Vec3(0, -110, 0));
  EXPECT_EQ(at(**source, 220).camera.position, Vec3(0, -2, 0));
  // it starts and stops without speed
  EXPECT_LT(std::abs(at(**source, 60.1).camera.position->y + 200), 2e-6);
  EXPECT_LT(std::abs(at(**source, 159.9).camera.position->y + 20), 2e-6);
  EXPECT_FALSE(hold_point_source("", {}, log));
  EXPECT_FALSE(hold_point_source("", {{0, 60, {}}, {50, 70, {}}}, log));
  EXPECT_FALSE(hold_point_source("", {{0, std::nan(""), {}}}, log));
  EXPECT_EQ(codes(log), "E8004 E8004 E8001");
}

}  // namespace
}  // namespace panwright::scenario::formulas_test
