// Joints: their motions, and the values that point them at a target.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/math.h"

namespace panwright::geometry {

// Kind of a joint, in the order of the pan file.
enum class JointKind : std::uint8_t {
  fixed,       // no value
  revolute,    // 1: radians about the axis, between limits
  continuous,  // 1: radians about the axis, without limits, any number of turns
  prismatic,   // 1: metres along the axis
  ball,        // 3: radians about the fixed x, then y, then z: R = Rz·Ry·Rx
  general,     // 9: scale x y z, then rotation as of a ball, then translation x y z: T·R·S
  scale,       // 1: the factor along x, y or z, for those where the axis has a component
};
inline constexpr std::size_t kJointKinds = 7;
inline constexpr std::size_t kMaxJointValues = 9;

// Values of one joint; those after value_count() are 0.
using JointValues = std::array<double, kMaxJointValues>;

std::size_t value_count(JointKind kind);
// Returns "revolute"…
std::string_view kind_name(JointKind kind);
std::optional<JointKind> kind_named(std::string_view name);
// Returns the values at rest: 0, and 1 for factors.
JointValues rest_values(JointKind kind);

enum class JointUnit : std::uint8_t { radians, metres, factor };
// Expects: index < value_count(kind).
JointUnit unit_of(JointKind kind, std::size_t index);

struct Joint {
  JointKind kind = JointKind::fixed;
  Vec3 axis{0, 0, 1};    // unit, in the node's frame
  bool limited = false;  // by lower and upper
  JointValues lower{};
  JointValues upper{};
  // Index of the joint to follow: value = multiplier·(value of that one) + offset. −1: none.
  std::int32_t mimic = -1;
  double multiplier = 1;
  double offset = 0;
};

// Returns true if a joint can follow another: both of one value.
bool can_mimic(const Joint& joint);

// Returns the matrix of a joint's motion in its node's frame: I at rest_values(). A rotation is
// Rodrigues' formula, with 1 − cos q = 2 sin²(q/2): orthogonal to 4e-16, and q and −q are inverse
// to the same accuracy. Both from the sine and cosine of half the angle.
//
// Expects: a unit axis, finite values.
Mat4 motion(const Joint& joint, const JointValues& values);

// Returns a·b of two affine matrices, with the bits of the full product.
Mat4 affine_product(const Mat4& a, const Mat4& b);

// Returns an angle in (−π, π], from one of at most 2^53 radians, as exact as the given one.
double wrapped_angle(double angle);

// Returns the values of a joint clamped to its limits.
JointValues clamped(const Joint& joint, const JointValues& values);

// Joints of one model, in an order in which leaders precede followers.
class JointSet {
 public:
  // Returns nullopt for a joint that follows itself, directly or through others, one that follows a
  // missing joint, or a pair without can_mimic(). `wrong`, when given, is the first such joint.
  static std::optional<JointSet> of(std::vector<Joint> joints, std::size_t* wrong = nullptr);

  JointSet() = default;
  std::span<const Joint> joints() const { return joints_; }
  std::size_t size() const { return joints_.size(); }
  const Joint& operator[](std::size_t index) const { return joints_[index]; }

  // Clamps the values in place, then computes those of followers, clamped as well; given values of
  // followers are not read.
  //
  // Expects: as many values as joints. Cost: O(joints).
  void resolve(std::span<JointValues> values) const;

 private:
  std::vector<Joint> joints_;
  std::vector<std::uint32_t> followers_;  // leaders before those that follow them
};

// ---- pointing

// Closest pointing of a joint about an axis: the largest cos(angle) between R(axis, q)·v and the
// target that the limits allow. Closed form: 1e-15 of the angle. If no angle is better than another
// (v or the target along the axis), `now`, within the limits.
//
// axis, v, target  any length above 0, all in the frame of the joint's node at rest
struct Pointing {
  JointValues values{};
  double error = 0;  // radians between the pointing direction and the target
};
Pointing point_one(const Joint& joint, const Vec3& v, const Vec3& target, double now);

// The same of two joints, the outer one first: R(outer, a)·M·R(inner, b)·v. Closed form (Paden and
// Kahan's second subproblem) where both angles are within their limits; of its two solutions, the
// nearer to the joints' present values. Else the best on the limits.
//
//   outer_from_inner  the rotation between the two at rest
//   target            in the outer joint's frame
struct PointingPair {
  double outer = 0;
  double inner = 0;
  double error = 0;
};
PointingPair point_two(const Joint& outer, const Mat3& outer_from_inner, const Joint& inner,
                       const Vec3& v, const Vec3& target, double outer_now, double inner_now);

}  // namespace panwright::geometry
