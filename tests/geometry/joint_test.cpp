// Joint motions against other formulas, and joints that follow joints.
#include "geometry/kinematics/joint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace panwright::geometry::joint_test {
namespace {

double difference(const Mat4& a, const Mat4& b) {
  double worst = 0;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) worst = std::max(worst, std::fabs(a[c][r] - b[c][r]));
  return worst;
}

Vec3 random_unit(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  for (;;) {
    const Vec3 v(normal(random), normal(random), normal(random));
    if (glm::length(v) > 1e-3) return glm::normalize(v);
  }
}

JointValues one(double value) {
  JointValues out{};
  out[0] = value;
  return out;
}

Joint joint(JointKind kind, const Vec3& axis = {0, 0, 1}) {
  Joint out;
  out.kind = kind;
  out.axis = axis;
  return out;
}

TEST(Joint, MovesNothingAtRest) {
  for (std::size_t k = 0; k < kJointKinds; ++k) {
    const auto kind = static_cast<JointKind>(k);
    EXPECT_EQ(motion(joint(kind, glm::normalize(Vec3(1, 2, 3))), rest_values(kind)), Mat4(1))
        << kind_name(kind);
    EXPECT_EQ(kind_named(kind_name(kind)), kind);
  }
  EXPECT_FALSE(kind_named("hinge"));
}

// Rotations by the exponential of the axis's cross-product matrix, as a series in long double.
TEST(Joint, TurnsAsTheExponentialOfItsAxis) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angles(-2 * kPi, 2 * kPi);
  double worst = 0, worst_inverse = 0, worst_det = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 axis =
        i < 6 ? Vec3(i == 0 || i == 3, i == 1 || i == 4, i == 2 || i == 5) * (i < 3 ? 1.0 : -1.0)
              : random_unit(random);
    const double q = i % 7 == 0 ? std::ldexp(angles(random), -30) : angles(random);
    using Big = long double;
    Big k[3][3] = {{0, -Big(axis.z), Big(axis.y)},
                   {Big(axis.z), 0, -Big(axis.x)},
                   {-Big(axis.y), Big(axis.x), 0}};
    Big sum[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
        term[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int n = 1; n < 60; ++n) {
      Big next[3][3] = {};
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          for (int m = 0; m < 3; ++m) next[r][c] += term[r][m] * k[m][c] * Big(q) / n;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) sum[r][c] += term[r][c] = next[r][c];
    }
    const Mat4 m = motion(joint(JointKind::revolute, axis), one(q));
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        worst = std::max(worst, std::fabs(m[c][r] - static_cast<double>(sum[r][c])));
    const Mat4 back = motion(joint(JointKind::continuous, axis), one(-q));
    worst_inverse = std::max(worst_inverse, difference(m * back, Mat4(1)));
    worst_det = std::max(worst_det, std::fabs(glm::determinant(Mat3(m)) - 1));
  }
  EXPECT_LE(worst, 2e-15);            // measured 6e-16: of the axis's length among others
  EXPECT_LE(worst_inverse, 2.5e-15);  // measured 7e-16, with clang 2.2e-15
  EXPECT_LE(worst_det, 2.5e-15);      // measured 7e-16, with clang 2.2e-15
}

// What 1 − cos q loses: of a turn of 1e-9 the part along the radius is 5e-19.
TEST(Joint, SmallTurnsKeepTheirDigits) {
  const double q = 1e-6;
  const Mat4 m = motion(joint(JointKind::revolute, {0, 0, 1}), one(q));
  EXPECT_NEAR((1 - m[0][0]) / (0.5 * q * q), 1, 3e-4);  // 1 has no more digits there: 2.2e-4
  EXPECT_NEAR(m[0][1] / q, 1, 1e-12);
  const Vec3 axis = glm::normalize(Vec3(1, 1, 0));
  const Mat4 tilted = motion(joint(JointKind::revolute, axis), one(q));
  EXPECT_NEAR(tilted[1][0] / (0.25 * q * q), 1, 1e-9);  // measured 4e-13; 1 − cos: 1e-4
}

TEST(Joint, ManyTurnsAreThoseTurns) {
  // 2πn as a double is off by up to n·2.4e-16; what is left of it is that error
  const Joint spin = joint(JointKind::continuous);
  for (const double turns : {1.0, 1000.0, 1e6}) {
    const Mat4 m = motion(spin, one(0.25 + turns * (2 * kPi)));
    const double off = std::atan2(m[0][1], m[0][0]) - 0.25;
    EXPECT_LE(std::fabs(off), 3e-16 * std::max(turns * 2 * kPi, 1.0)) << turns;
    EXPECT_NEAR(wrapped_angle(0.25 + turns * (2 * kPi)), 0.25, 3e-16 * turns * 2 * kPi);
  }
  EXPECT_EQ(wrapped_angle(kPi), kPi);
  EXPECT_EQ(wrapped_angle(-kPi), kPi);
  EXPECT_EQ(wrapped_angle(-1), -1);
}

// Shifts, scales and all nine numbers at once, by the matrices that they are said to be.
TEST(Joint, OtherKindsAreTheirMatrices) {
  const Vec3 axis = glm::normalize(Vec3(1, -2, 2));
  EXPECT_LE(
      glm::length(Vec3(motion(joint(JointKind::prismatic, axis), one(3))[3]) - Vec3(1, -2, 2)),
      1e-15);
  const Mat4 stretched = motion(joint(JointKind::scale, {0, 1, 0}), one(2.5));
  EXPECT_EQ(stretched * Vec4(1, 1, 1, 1), Vec4(1, 2.5, 1, 1));
  const Mat4 grown = motion(joint(JointKind::scale, glm::normalize(Vec3(1))), one(2));
  EXPECT_EQ(grown * Vec4(1, 2, 3, 1), Vec4(2, 4, 6, 1));
  const double x = 0.3, y = -1.1, z = 2.2;
  const Mat3 rx(1, 0, 0, 0, std::cos(x), std::sin(x), 0, -std::sin(x), std::cos(x));
  const Mat3 ry(std::cos(y), 0, -std::sin(y), 0, 1, 0, std::sin(y), 0, std::cos(y));
  const Mat3 rz(std::cos(z), std::sin(z), 0, -std::sin(z), std::cos(z), 0, 0, 0, 1);
  JointValues ball{x, y, z};
  EXPECT_LE(difference(motion(joint(JointKind::ball), ball), Mat4(rz * ry * rx)), 4e-16);
  const JointValues nine{2, -3, 0.5, x, y, z, 7, 8, 9};
  Mat4 expected(rz * ry * rx * Mat3(2, 0, 0, 0, -3, 0, 0, 0, 0.5));
  expected[3] = Vec4(7, 8, 9, 1);
  EXPECT_LE(difference(motion(joint(JointKind::general), nine), expected), 2e-15);
}

// A planar arm of n links of length 1: its tip is at the sum of (cos, sin) of summed angles.
TEST(Joint, ChainsAreClosedForms) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> angles(-kPi, kPi);
  for (const int links : {2, 7, 100}) {
    double worst = 0;
    for (int run = 0; run < 50; ++run) {
      Mat4 chain(1);
      Mat4 link(1);
      link[3] = Vec4(1, 0, 0, 1);
      long double x = 0, y = 0, sum = 0;
      for (int i = 0; i < links; ++i) {
        const double q = angles(random);
        chain = chain * motion(joint(JointKind::revolute), one(q)) * link;
        sum += q;
        x += std::cos(sum);
        y += std::sin(sum);
      }
      worst = std::max({worst, std::fabs(chain[3].x - static_cast<double>(x)),
                        std::fabs(chain[3].y - static_cast<double>(y))});
    }
    EXPECT_LE(worst, 1e-12) << links;  // measured 4e-16, 2e-15, 5e-14
  }
}

TEST(JointSet, FollowersTakeWhatTheirLeadersTook) {
  Joint leader = joint(JointKind::revolute);
  leader.limited = true;
  leader.lower = one(-1);
  leader.upper = one(1);
  Joint second = joint(JointKind::continuous), third = second;
  second.mimic = 3;
  second.multiplier = -2;
  second.offset = 0.5;
  third.mimic = 1;
  third.multiplier = 3;
  third.limited = false;
  Joint gripper = joint(JointKind::prismatic);
  gripper.mimic = 3;
  gripper.limited = true;
  gripper.lower = one(0);
  gripper.upper = one(0.25);
  // followers stand before what they follow
  auto set = JointSet::of({third, second, gripper, leader});
  ASSERT_TRUE(set);
  std::vector<JointValues> values{one(9), one(9), one(9), one(5)};
  set->resolve(values);
  EXPECT_EQ(values[3][0], 1);     // limited first
  EXPECT_EQ(values[1][0], -1.5);  // -2·1 + 0.5
  EXPECT_EQ(values[0][0], -4.5);  // gains multiply
  EXPECT_EQ(values[2][0], 0.25);  // limited after it has followed
}

// A screw: a turn and a shift that follows it by pitch/2π.
TEST(JointSet, AScrewAdvancesByItsPitch) {
  const double pitch = 0.002;
  Joint turn = joint(JointKind::continuous), shift = joint(JointKind::prismatic);
  shift.mimic = 0;
  shift.multiplier = pitch / (2 * kPi);
  auto set = JointSet::of({turn, shift});
  ASSERT_TRUE(set);
  for (const double turns : {0.25, 1.0, 50.5}) {
    std::vector<JointValues> values{one(turns * 2 * kPi), {}};
    set->resolve(values);
    const Mat4 m = motion(turn, values[0]) * motion(shift, values[1]);
    EXPECT_NEAR(m[3].z, pitch * turns, 1e-15 * turns);
  }
}

TEST(JointSet, LoopsAndWhatCannotFollowAreRefused) {
  const auto wrong = [](std::vector<Joint> joints) {
    std::size_t at = 99;
    EXPECT_FALSE(JointSet::of(std::move(joints), &at));
    return at;
  };
  Joint a = joint(JointKind::revolute);
  a.mimic = 0;
  EXPECT_EQ(wrong({a}), 0u);
  Joint b = joint(JointKind::revolute), c = b;
  a.mimic = 1;
  b.mimic = 2;
  c.mimic = 0;
  EXPECT_EQ(wrong({a, b, c}), 0u);
  const Joint free = joint(JointKind::revolute);
  a.mimic = 7;
  EXPECT_EQ(wrong({free, a}), 1u);
  a.mimic = 1;
  EXPECT_EQ(wrong({a, joint(JointKind::ball)}), 0u);
  Joint ball = joint(JointKind::ball);
  ball.mimic = 0;
  EXPECT_EQ(wrong({free, ball}), 1u);
  // a long line of them, given from its end
  std::vector<Joint> line(20000, joint(JointKind::continuous));
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
    line[i].mimic = static_cast<std::int32_t>(i + 1);
  auto set = JointSet::of(line);
  ASSERT_TRUE(set);
  std::vector<JointValues> values(line.size());
  values.back() = one(0.5);
  set->resolve(values);
  EXPECT_EQ(values.front()[0], 0.5);
}

// ---- pointing

Vec3 pointed(const Joint& j, double q, const Vec3& v) { return Mat3(motion(j, one(q))) * v; }

// The best of many angles, refined by thirds: knows nothing of the closed form.
double best_cosine(const Joint& j, const Vec3& v, const Vec3& target) {
  const bool limited = j.limited && j.kind == JointKind::revolute;
  const double low = limited ? j.lower[0] : -kPi, high = limited ? j.upper[0] : kPi;
  const auto score = [&](double q) { return glm::dot(pointed(j, q, v), target); };
  constexpr int kSteps = 400;
  double best = low;
  for (int i = 0; i <= kSteps; ++i) {
    const double q = low + (high - low) * i / kSteps;
    if (score(q) > score(best)) best = q;
  }
  double from = std::max(low, best - (high - low) / kSteps);
  double to = std::min(high, best + (high - low) / kSteps);
  for (int i = 0; i < 200; ++i) {
    const double a = from + (to - from) / 3, b = to - (to - from) / 3;
    if (score(a) < score(b))
      from = a;
    else
      to = b;
  }
  return score(0.5 * (from + to));
}

TEST(Pointing, OneAxisIsTheBestThatLimitsAllow) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> angles(-4, 4);
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    Joint j = joint(i % 2 ? JointKind::revolute : JointKind::continuous, random_unit(random));
    if (i % 2) {
      j.limited = true;
      const double a = angles(random), b = angles(random);
      j.lower = one(std::min(a, b));
      j.upper = one(std::max(a, b));
    }
    const Vec3 v = random_unit(random), target = random_unit(random);
    const Pointing found = point_one(j, 3.0 * v, 1e-3 * target, 0);
    if (i % 2) {
      EXPECT_GE(found.values[0], j.lower[0]);
      EXPECT_LE(found.values[0], j.upper[0]);
    }
    const Vec3 at = pointed(j, found.values[0], v);
    worst = std::max(worst, best_cosine(j, v, target) - glm::dot(at, target));
    EXPECT_NEAR(found.error, angle_between(at, target), 1e-14);
  }
  EXPECT_LE(worst, 1e-12);  // measured 3e-16
}

// Where nothing is better than anything else, a joint stays where it is.
TEST(Pointing, AlongTheAxisNothingMoves) {
  Joint j = joint(JointKind::revolute, {0, 0, 1});
  j.limited = true;
  j.lower = one(-1);
  j.upper = one(1);
  EXPECT_EQ(point_one(j, {0, 0, 1}, {1, 0, 0}, 0.75).values[0], 0.75);
  EXPECT_EQ(point_one(j, {1, 0, 0}, {0, 0, -2}, 0.75).values[0], 0.75);
  EXPECT_EQ(point_one(j, {1, 0, 0}, {0, 0, -2}, 3).values[0], 1);
  // of two equally good limits, and of several turns, the nearer
  Joint wide = j;
  wide.lower = one(-10);
  wide.upper = one(10);
  EXPECT_NEAR(point_one(wide, {1, 0, 0}, {0, 1, 0}, 7).values[0], kPi / 2 + 2 * kPi, 1e-15);
  EXPECT_NEAR(point_one(wide, {1, 0, 0}, {0, 1, 0}, -5).values[0], kPi / 2 - 2 * kPi, 1e-15);
}

TEST(Pointing, TwoAxesReachEveryDirectionTheyCan) {
  std::mt19937_64 random(4);
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    // azimuth over elevation: axes and boresight at right angles
    const Mat3 turn(motion(joint(JointKind::revolute, random_unit(random)), one(i)));
    const Joint outer = joint(JointKind::continuous, turn * Vec3(0, 0, 1));
    const Joint inner = joint(JointKind::continuous, {0, 1, 0});
    const Vec3 target = i < 4 ? turn * Vec3(0, 0, i % 2 ? 1 : -1) : random_unit(random);
    const PointingPair found = point_two(outer, turn, inner, {0, 0, 1}, target, 0.1, 0.2);
    const Vec3 at = pointed(outer, found.outer, turn * pointed(inner, found.inner, {0, 0, 1}));
    worst = std::max(worst, angle_between(at, target));
    EXPECT_NEAR(found.error, angle_between(at, target), 1e-14);
  }
  EXPECT_LE(worst, 1e-12);  // measured 5e-16
}

// Any two axes, with limits, against a search over both angles.
TEST(Pointing, TwoAxesWithLimitsAreAsGoodAsASearch) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> angles(-2.5, 2.5);
  double worst = 0;
  for (int i = 0; i < 60; ++i) {
    const Mat3 between(motion(joint(JointKind::revolute, random_unit(random)), one(i)));
    Joint outer = joint(JointKind::revolute, random_unit(random)), inner = outer;
    inner.axis = random_unit(random);
    for (Joint* j : {&outer, &inner}) {
      const double a = angles(random), b = angles(random);
      j->limited = true;
      j->lower = one(std::min(a, b));
      j->upper = one(std::max(a, b));
    }
    const Vec3 v = random_unit(random), target = random_unit(random);
    const PointingPair found = point_two(outer, between, inner, v, target, 0, 0);
    for (const auto& [value, j] : {std::pair(found.outer, outer), std::pair(found.inner, inner)}) {
      EXPECT_GE(value, j.lower[0]);
      EXPECT_LE(value, j.upper[0]);
    }
    const auto score = [&](double a, double b) {
      return glm::dot(pointed(outer, a, between * pointed(inner, b, v)), target);
    };
    // a grid over both, then ever finer around the best
    double low_a = outer.lower[0], high_a = outer.upper[0], low_b = inner.lower[0],
           high_b = inner.upper[0], best = -2;
    for (int level = 0; level < 30; ++level) {
      constexpr int kSteps = 40;
      double best_a = low_a, best_b = low_b;
      for (int x = 0; x <= kSteps; ++x)
        for (int y = 0; y <= kSteps; ++y) {
          const double a = low_a + (high_a - low_a) * x / kSteps;
          const double b = low_b + (high_b - low_b) * y / kSteps;
          if (score(a, b) <= best) continue;
          best = score(a, b);
          best_a = a;
          best_b = b;
        }
      const double da = 0.15 * (high_a - low_a), db = 0.15 * (high_b - low_b);
      low_a = std::max(outer.lower[0], best_a - da);
      high_a = std::min(outer.upper[0], best_a + da);
      low_b = std::max(inner.lower[0], best_b - db);
      high_b = std::min(inner.upper[0], best_b + db);
    }
    worst = std::max(worst, best - score(found.outer, found.inner));
  }
  EXPECT_LE(worst, 1e-12);  // measured below
}

}  // namespace
}  // namespace panwright::geometry::joint_test
