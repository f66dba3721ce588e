// Vectors, and elementary functions whose last bit does not depend on the machine.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

namespace panwright {

using Vec2 = glm::dvec2;
using Vec3 = glm::dvec3;
using Vec4 = glm::dvec4;
using Mat3 = glm::dmat3;  // column vectors
using Mat4 = glm::dmat4;  // column vectors
using Quat = glm::dquat;  // w x y z

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180.0;  // radians

// Elementary functions over SLEEF's deterministic scalar forms: the same bits on every processor,
// within 1 ulp. All code that decides a byte of a pan uses these, never libm. Arguments in radians.
// (sqrt, fabs, floor, fmin… are exact in IEEE 754 and come from <cmath>.)
namespace det {
struct SinCos {
  double sin;
  double cos;
};
double sin(double x);
double cos(double x);
SinCos sincos(double x);
double tan(double x);
double asin(double x);
double acos(double x);
double atan(double x);
double atan2(double y, double x);
double exp(double x);
double log(double x);
double log10(double x);
double pow(double x, double y);
double hypot(double x, double y);
}  // namespace det

// The angle between two vectors, radians in [0, π], stable near 0 and π (unlike acos of a dot).
double angle_between(const Vec3& a, const Vec3& b);

// Rotation from three angles about fixed axes x, then y, then z: R = Rz·Ry·Rx, radians.
Quat quat_from_fixed_xyz(const Vec3& angles);

// Normals transform by the cofactor matrix: det(M)·M⁻ᵀ, finite for singular M as well.
Mat3 cofactor(const Mat3& m);

// Translation, rotation and scale as one matrix: p' = T·R·S·p.
Mat4 matrix_from_trs(const Vec3& translation, const Quat& rotation, const Vec3& scale);

// Factors by which a matrix's linear part stretches lengths: its singular values, to a few ulps
// each. 0 where it flattens space.
struct Stretch {
  double smallest = 1;
  double largest = 1;
};
Stretch stretch_of(const Mat4& m);

bool is_finite(const Vec3& v);

// The largest of three components, with its sign.
inline double max_component(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

}  // namespace panwright
