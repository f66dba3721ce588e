// Interpolation against polynomials, circular motion and constant spin.
#include "scenario/interpolate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/scenario/support.h"

namespace panwright::scenario::interpolate_test {
namespace {

using support::turn_between;

// A polynomial of a degree, and its derivative, in long double.
struct Polynomial {
  int degree = 0;
  Vec3 value(double time) const { return of(time, false); }
  Vec3 rate(double time) const { return of(time, true); }
  Vec3 of(double time, bool rate) const {
    long double sum[3] = {};
    for (int k = 0; k <= degree; ++k)
      for (int c = 0; c < 3; ++c) {
        const long double coefficient = ((k * 7 + c * 3) % 5) - 2.0L + (k == degree ? 0.5L : 0);
        if (rate && k == 0) continue;
        sum[c] += rate ? coefficient * k * std::pow(static_cast<long double>(time), k - 1)
                       : coefficient * std::pow(static_cast<long double>(time), k);
      }
    return {static_cast<double>(sum[0]), static_cast<double>(sum[1]), static_cast<double>(sum[2])};
  }
};

TEST(Interpolate, PolynomialsAreExact) {
  const std::vector<double> times = {-1, -0.6, -0.3, 0.1, 0.4, 0.7, 0.75, 1};
  for (std::size_t n = 1; n <= times.size(); ++n) {
    const auto nodes = std::span(times).first(n);
    const Polynomial through{static_cast<int>(n) - 1}, touching{2 * static_cast<int>(n) - 1};
    std::vector<Vec3> values, touched, rates;
    for (const double time : nodes) {
      values.push_back(through.value(time));
      touched.push_back(touching.value(time));
      rates.push_back(touching.rate(time));
    }
    for (const double time : {-0.9, -0.31, 0.05, 0.6, 0.99}) {
      if (time > nodes.back()) continue;
      // 4e-15 and 2e-13 measured
      EXPECT_LT(length(lagrange(nodes, values, time) - through.value(time)), 1e-13) << n;
      EXPECT_LT(length(hermite(nodes, touched, rates, time) - touching.value(time)), 2e-12) << n;
    }
    if (n >= 2) {  // and no more: the next degree is not kept
      const Polynomial next{static_cast<int>(n)};
      std::vector<Vec3> others;
      for (const double time : nodes) others.push_back(next.value(time));
      EXPECT_GT(length(lagrange(nodes, others, (nodes[0] + nodes[1]) / 2) -
                       next.value((nodes[0] + nodes[1]) / 2)),
                1e-4);
    }
  }
}

// Worst error in the middle of steps, metres, on a circular orbit 400 km above the Earth.
double orbit_error(double step, std::size_t nodes, bool with_velocities) {
  const double radius = 6778e3;
  const double rate = std::sqrt(3.986004418e14 / (radius * radius * radius));
  std::vector<double> times;
  std::vector<Vec3> positions, velocities;
  const auto position = [&](double t) {
    return Vec3(radius * std::cos(rate * t), radius * std::sin(rate * t) * 0.6,
                radius * std::sin(rate * t) * 0.8);
  };
  for (int i = 0; i < 40; ++i) {
    const double t = i * step;
    times.push_back(t);
    positions.push_back(position(t));
    velocities.push_back(rate * Vec3(-radius * std::sin(rate * t),
                                     radius * std::cos(rate * t) * 0.6,
                                     radius * std::cos(rate * t) * 0.8));
  }
  double worst = 0;
  for (std::size_t i = 10; i < 30; ++i) {
    const double t = times[i] + step / 2;
    const std::size_t first = first_node(times, t, nodes);
    const auto part = [&](const auto& all) { return std::span(all).subspan(first, nodes); };
    const Vec3 found =
        with_velocities ? hermite(part(std::as_const(times)), part(std::as_const(positions)),
                                  part(std::as_const(velocities)), t)
                        : lagrange(part(std::as_const(times)), part(std::as_const(positions)), t);
    worst = std::max(worst, length(found - position(t)));
  }
  return worst;
}

// The error of a polynomial through equal steps is known: |f⁽ᵐ⁾| / m! · Π|t − t_i|.
double expected_error(double step, std::size_t nodes, bool with_velocities) {
  const double radius = 6778e3;
  const double rate = std::sqrt(3.986004418e14 / (radius * radius * radius));
  double product = radius;
  int order = 0;
  for (std::size_t i = 0; i < nodes; ++i)
    for (int twice = 0; twice < (with_velocities ? 2 : 1); ++twice) {
      const double distance =
          std::abs(static_cast<double>(i) - static_cast<double>(nodes / 2) + 0.5) * step;
      product *= distance * rate / ++order;
    }
  return product;
}

TEST(Interpolate, ErrorPerNodeStep) {
  for (const double step : {60.0, 180.0}) {
    for (const std::size_t nodes : {2u, 4u, 6u, 8u}) {
      const double expected = expected_error(step, nodes, false);
      // rounding of positions of 7e6 m: 2e-9 measured
      EXPECT_NEAR(orbit_error(step, nodes, false), expected, 0.1 * expected + 5e-9)
          << step << nodes;
    }
    for (const std::size_t nodes : {2u, 4u}) {
      const double expected = expected_error(step, nodes, true);
      EXPECT_NEAR(orbit_error(step, nodes, true), expected, 0.1 * expected + 5e-9) << step << nodes;
    }
  }
  // orders of magnitude for ephemerides in low orbits
  EXPECT_NEAR(orbit_error(60, 2, false), 3.9e3, 0.1e3);
  EXPECT_NEAR(orbit_error(60, 2, true), 0.37, 0.05);
  EXPECT_NEAR(orbit_error(60, 6, false), 3.2e-3, 0.5e-3);
  EXPECT_LT(orbit_error(60, 4, true), 4e-8);
}

TEST(Interpolate, ConstantSpin) {
  const Vec3 axis = normalize(Vec3(1, -2, 0.5));
  const auto spin = [&](double angle) {
    return Quat(std::cos(angle / 2), axis * std::sin(angle / 2));
  };
  const Quat start = normalize(Quat(0.3, 0.1, -0.7, 0.4));
  std::vector<double> times;
  std::vector<Quat> values;
  for (int i = 0; i < 9; ++i) {
    times.push_back(i * i * 0.25 + i);
    values.push_back(start * spin(0.2 * times.back()));
    if (i % 2) values.back() = -values.back();
  }
  for (double time = 0; time < 20; time += 0.37) {
    const Quat truth = start * spin(0.2 * time);
    const std::size_t i = first_node(times, time, 2);
    // 6e-16 and 9e-16 measured
    EXPECT_LT(
        turn_between(slerp(values[i], values[i + 1], (time - times[i]) / (times[i + 1] - times[i])),
                     truth),
        1e-15);
    EXPECT_LT(turn_between(cubic(times, values, time), truth), 1e-15);
  }
  EXPECT_EQ(turn_between(slerp(values[0], values[1], 1), values[1]), 0);
}

// The cubic curve has no jump of angular velocity at nodes, and slerp has one.
TEST(Interpolate, CubicTurnsSmoothly) {
  const std::vector<double> times = {0, 1, 1.5, 3};
  const std::vector<Quat> values = {Quat(1, 0, 0, 0), normalize(Quat(1, 0.8, 0, 0)),
                                    normalize(Quat(0.2, 0.9, 0.6, -0.3)),
                                    normalize(Quat(-0.4, 0.1, 0.9, 0.2))};
  const double h = 1e-5;
  for (const std::size_t node : {1u, 2u}) {
    const double t = times[node];
    const auto rate = [&](double from, double to) {
      const Quat turn = conjugate(cubic(times, values, from)) * cubic(times, values, to);
      return 2.0 * Vec3(turn.x, turn.y, turn.z) / (to - from) * (turn.w < 0 ? -1.0 : 1.0);
    };
    EXPECT_LT(length(rate(t - h, t) - rate(t, t + h)), 2e-4);
    EXPECT_LT(turn_between(cubic(times, values, t), values[node]), 1e-15);
  }
}

TEST(Interpolate, CubicKeepsParabolas) {
  const std::vector<double> times = {0, 1, 1.7, 3, 3.2};
  std::vector<Vec3> values;
  const auto f = [](double t) { return Vec3(1 + t, 2 * t * t, -t * t + 3 * t); };
  for (const double t : times) values.push_back(f(t));
  for (const double t : {0.2, 1.3, 2.9, 3.1, 3.2})
    EXPECT_LT(length(cubic(times, values, t) - f(t)), 1e-14);
}

TEST(Interpolate, NodeWindows) {
  const std::vector<double> times = {0, 1, 2, 3, 4, 5, 6, 7};
  EXPECT_EQ(first_node(times, 3.4, 4), 2u);
  EXPECT_EQ(first_node(times, 0.1, 4), 0u);
  EXPECT_EQ(first_node(times, 6.9, 4), 4u);
  EXPECT_EQ(first_node(times, 3.4, 3), 2u);
  EXPECT_EQ(first_node(times, 3.6, 3), 3u);
  EXPECT_EQ(first_node(times, 7, 8), 0u);
}

}  // namespace
}  // namespace panwright::scenario::interpolate_test
