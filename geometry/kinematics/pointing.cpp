// Joint values that point at something.
#include <algorithm>
#include <cassert>
#include <cmath>

#include "geometry/kinematics/joint.h"

namespace panwright::geometry {
namespace {

// Below it, a part across an axis is none: its direction would be noise.
constexpr double kAlong = 1e-14;

struct AngleRange {
  double lower = -HUGE_VAL;
  double upper = HUGE_VAL;
};

AngleRange range_of(const Joint& joint) {
  if (joint.kind == JointKind::continuous || !joint.limited) return {};
  return {joint.lower[0], joint.upper[0]};
}

[[maybe_unused]] bool turns(const Joint& joint) {
  return joint.kind == JointKind::revolute || joint.kind == JointKind::continuous;
}

// That of q + 2πn that lies in the range, nearest to `now`; none: no such.
bool place(double q, const AngleRange& range, double now, double& out) {
  if (range.lower == -HUGE_VAL && range.upper == HUGE_VAL) {
    out = wrapped_angle(q);
    return true;
  }
  constexpr double kTurn = 2 * kPi;
  // a solution on a limit stays one when rounding takes it across
  const double slack = 4e-15 * std::max({1.0, std::fabs(range.lower), std::fabs(range.upper)});
  const double first = std::ceil((range.lower - slack - q) / kTurn);
  const double last = std::floor((range.upper + slack - q) / kTurn);
  if (!(first <= last)) return false;
  const double n = std::min(std::max(std::nearbyint((now - q) / kTurn), first), last);
  out = std::min(std::max(q + n * kTurn, range.lower), range.upper);
  return true;
}

// The best angle about a unit axis within a range. `closest`: none is better than another.
double best_angle(const Vec3& axis, const AngleRange& range, const Vec3& v, const Vec3& target,
                  double now) {
  const Vec3 a = v - glm::dot(axis, v) * axis;
  const Vec3 b = target - glm::dot(axis, target) * axis;
  const double stay = std::min(std::max(now, range.lower), range.upper);
  if (glm::length(a) <= kAlong || glm::length(b) <= kAlong) return stay;
  const double q = det::atan2(glm::dot(axis, glm::cross(a, b)), glm::dot(a, b));
  double out = 0;
  if (place(q, range, now, out)) return out;
  // cos(x − q) at the two limits
  const double at_lower = det::cos(range.lower - q), at_upper = det::cos(range.upper - q);
  return at_lower >= at_upper ? range.lower : range.upper;
}

Vec3 turned(const Joint& joint, double angle, const Vec3& v) {
  JointValues values{};
  values[0] = angle;
  return Mat3(motion(joint, values)) * v;
}

// How far an angle is from another, whole turns aside.
double distance(double a, double b) { return std::fabs(wrapped_angle(a - b)); }

}  // namespace

Pointing point_one(const Joint& joint, const Vec3& v, const Vec3& target, double now) {
  assert(turns(joint));
  const Vec3 from = glm::normalize(v), to = glm::normalize(target);
  Pointing out;
  out.values[0] = best_angle(joint.axis, range_of(joint), from, to, now);
  out.error = angle_between(turned(joint, out.values[0], from), to);
  return out;
}

PointingPair point_two(const Joint& outer, const Mat3& outer_from_inner, const Joint& inner,
                       const Vec3& v, const Vec3& target, double outer_now, double inner_now) {
  assert(turns(outer) && turns(inner));
  const Vec3 u = glm::normalize(v), to = glm::normalize(target);
  const AngleRange range_outer = range_of(outer), range_inner = range_of(inner);
  PointingPair best;
  best.error = HUGE_VAL;
  double best_distance = HUGE_VAL;
  const auto consider = [&](double a, double b) {
    const double error =
        angle_between(turned(outer, a, outer_from_inner * turned(inner, b, u)), to);
    const double away = distance(a, outer_now) + distance(b, inner_now);
    // equally good within rounding: the nearer one
    const bool better = error < best.error - 1e-13;
    if (better || (error < best.error + 1e-13 && away < best_distance)) {
      best = {a, b, error};
      best_distance = away;
    }
  };
  // The outer joint for an angle of the inner one, and the other way round.
  const auto with_inner = [&](double b) {
    consider(
        best_angle(outer.axis, range_outer, outer_from_inner * turned(inner, b, u), to, outer_now),
        b);
  };
  const auto with_outer = [&](double a) {
    const Vec3 target_inner = glm::transpose(outer_from_inner) * turned(outer, -a, to);
    consider(a, best_angle(inner.axis, range_inner, u, target_inner, inner_now));
  };
  // Inner angles at which R(b)·u has the target's part along the outer axis, which turning about
  // that axis does not change: p·cos b + q·sin b + r = s.
  const Vec3 w = glm::transpose(outer_from_inner) * outer.axis;  // the outer axis from within
  const Vec3 along = glm::dot(inner.axis, u) * inner.axis;
  const Vec3 across = u - along;
  const double p = glm::dot(w, across), q = glm::dot(w, glm::cross(inner.axis, across));
  const double s = glm::dot(outer.axis, to) - glm::dot(w, along);
  const double radius = det::hypot(p, q);
  if (radius > kAlong) {
    const double middle = det::atan2(q, p);
    const double cosine = std::min(std::max(s / radius, -1.0), 1.0);
    // near ±1 the angle of the cosine from what is left of s² keeps its digits
    const double sine = std::sqrt(std::max((radius - s) * (radius + s), 0.0)) / radius;
    const double spread = det::atan2(sine, cosine);
    for (const double sign : {1.0, -1.0}) {
      double b = 0;
      if (place(middle + sign * spread, range_inner, inner_now, b)) with_inner(b);
    }
  } else {
    with_inner(std::min(std::max(inner_now, range_inner.lower), range_inner.upper));
  }
  for (const double limit : {range_inner.lower, range_inner.upper})
    if (std::isfinite(limit)) with_inner(limit);
  for (const double limit : {range_outer.lower, range_outer.upper})
    if (std::isfinite(limit)) with_outer(limit);
  return best;
}

}  // namespace panwright::geometry
