#include "geometry/kinematics/joint.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace panwright::geometry {
namespace {

constexpr std::string_view kNames[kJointKinds] = {"fixed", "revolute", "continuous", "prismatic",
                                                  "ball",  "general",  "scale"};

// Rodrigues' formula: R = I + sin q·K + (1 − cos q)·K².
Mat3 turn(const Vec3& axis, double angle) {
  const auto [sine_half, cosine_half] = det::sincos(0.5 * angle);
  const double sine = 2 * sine_half * cosine_half;
  const double versed = 2 * sine_half * sine_half;
  Mat3 out;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) out[c][r] = versed * (axis[r] * axis[c]);
  for (int k = 0; k < 3; ++k) {
    // 1 + versed·(a² − 1), where cos q + versed·a² would lose what is small
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    out[k][k] = 1 - versed * (axis[i] * axis[i] + axis[j] * axis[j]);
    out[j][i] -= sine * axis[k];
    out[i][j] += sine * axis[k];
  }
  return out;
}

Mat3 turn_fixed_xyz(const double* angles) {
  return turn({0, 0, 1}, angles[2]) * turn({0, 1, 0}, angles[1]) * turn({1, 0, 0}, angles[0]);
}

Mat4 affine(const Mat3& linear, const Vec3& translation) {
  return Mat4(Vec4(linear[0], 0), Vec4(linear[1], 0), Vec4(linear[2], 0), Vec4(translation, 1));
}

double within(double value, double lower, double upper) {
  return std::min(std::max(value, lower), upper);
}

}  // namespace

std::size_t value_count(JointKind kind) {
  constexpr std::size_t kCounts[kJointKinds] = {0, 1, 1, 1, 3, 9, 1};
  return kCounts[static_cast<std::size_t>(kind)];
}

std::string_view kind_name(JointKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

std::optional<JointKind> kind_named(std::string_view name) {
  const auto* const found = std::find(std::begin(kNames), std::end(kNames), name);
  if (found == std::end(kNames)) return std::nullopt;
  return static_cast<JointKind>(found - kNames);
}

JointUnit unit_of(JointKind kind, std::size_t index) {
  assert(index < value_count(kind));
  switch (kind) {
    case JointKind::prismatic:
      return JointUnit::metres;
    case JointKind::scale:
      return JointUnit::factor;
    case JointKind::general:
      return index < 3 ? JointUnit::factor : index < 6 ? JointUnit::radians : JointUnit::metres;
    default:
      return JointUnit::radians;
  }
}

JointValues rest_values(JointKind kind) {
  JointValues out{};
  for (std::size_t i = 0; i < value_count(kind); ++i)
    out[i] = unit_of(kind, i) == JointUnit::factor ? 1 : 0;
  return out;
}

bool can_mimic(const Joint& joint) { return value_count(joint.kind) == 1; }

Mat4 motion(const Joint& joint, const JointValues& values) {
  switch (joint.kind) {
    case JointKind::fixed:
      return Mat4(1);
    case JointKind::revolute:
    case JointKind::continuous:
      return affine(turn(joint.axis, values[0]), Vec3(0));
    case JointKind::prismatic:
      return affine(Mat3(1), values[0] * joint.axis);
    case JointKind::ball:
      return affine(turn_fixed_xyz(values.data()), Vec3(0));
    case JointKind::general: {
      Mat3 linear = turn_fixed_xyz(values.data() + 3);
      for (int k = 0; k < 3; ++k) linear[k] *= values[static_cast<std::size_t>(k)];
      return affine(linear, {values[6], values[7], values[8]});
    }
    case JointKind::scale: {
      Mat3 linear(1);
      for (int k = 0; k < 3; ++k)
        if (joint.axis[k] != 0) linear[k][k] = values[0];
      return affine(linear, Vec3(0));
    }
  }
  return Mat4(1);
}

// Terms in the order in which the full product adds them; those with 0 are left out.
Mat4 affine_product(const Mat4& a, const Mat4& b) {
  Mat4 out;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 3; ++r) {
      const double sum = a[0][r] * b[c][0] + a[1][r] * b[c][1] + a[2][r] * b[c][2];
      out[c][r] = c == 3 ? sum + a[3][r] : sum;
    }
  out[0][3] = out[1][3] = out[2][3] = 0;
  out[3][3] = 1;
  return out;
}

// The remainder is exact by IEEE 754; of 2π as two doubles, so that many turns lose nothing.
double wrapped_angle(double angle) {
  constexpr double kTurn = 2 * kPi, kTurnRest = 2.4492935982947064e-16;
  if (angle > -kPi && angle <= kPi) return angle;
  const double turns = std::nearbyint(angle / kTurn);
  const double rest = std::fma(-turns, kTurn, angle) - turns * kTurnRest;
  if (rest <= -kPi) return rest + kTurn;
  return rest > kPi ? rest - kTurn : rest;
}

JointValues clamped(const Joint& joint, const JointValues& values) {
  JointValues out = values;
  const std::size_t count = value_count(joint.kind);
  for (std::size_t i = 0; i < kMaxJointValues; ++i) {
    if (i >= count)
      out[i] = 0;
    else if (joint.limited && joint.kind != JointKind::continuous)
      out[i] = within(values[i], joint.lower[i], joint.upper[i]);
  }
  return out;
}

std::optional<JointSet> JointSet::of(std::vector<Joint> joints, std::size_t* wrong) {
  JointSet out;
  const std::size_t count = joints.size();
  const auto refuse = [&](std::size_t i) {
    if (wrong != nullptr) *wrong = i;
    return std::nullopt;
  };
  enum : char { unknown, open, done };
  std::vector<char> state(count, unknown);
  std::vector<std::uint32_t> path;
  for (std::size_t i = 0; i < count; ++i) {
    path.clear();
    std::size_t at = i;
    while (state[at] == unknown) {
      state[at] = open;
      path.push_back(static_cast<std::uint32_t>(at));
      const std::int32_t leader = joints[at].mimic;
      if (leader == -1) break;
      if (leader < 0 || static_cast<std::size_t>(leader) >= count || !can_mimic(joints[at]) ||
          !can_mimic(joints[static_cast<std::size_t>(leader)]))
        return refuse(at);
      at = static_cast<std::size_t>(leader);
      if (state[at] == open) return refuse(i);
    }
    for (; !path.empty(); path.pop_back()) {
      state[path.back()] = done;
      if (joints[path.back()].mimic != -1) out.followers_.push_back(path.back());
    }
  }
  out.joints_ = std::move(joints);
  return out;
}

void JointSet::resolve(std::span<JointValues> values) const {
  assert(values.size() == joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i)
    if (joints_[i].mimic == -1) values[i] = clamped(joints_[i], values[i]);
  for (const std::uint32_t i : followers_) {
    const Joint& joint = joints_[i];
    JointValues own{};
    own[0] = joint.multiplier * values[static_cast<std::size_t>(joint.mimic)][0] + joint.offset;
    values[i] = clamped(joint, own);
  }
}

}  // namespace panwright::geometry
