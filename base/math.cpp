#include "base/math.h"

#include <sleef.h>

#include <cmath>
#include <utility>

namespace panwright {

namespace det {
double sin(double x) { return Sleef_cinz_sind1_u10purec(x); }
double cos(double x) { return Sleef_cinz_cosd1_u10purec(x); }
SinCos sincos(double x) {
  const Sleef_double_2 r = Sleef_cinz_sincosd1_u10purec(x);
  return {r.x, r.y};
}
double tan(double x) { return Sleef_cinz_tand1_u10purec(x); }
double asin(double x) { return Sleef_cinz_asind1_u10purec(x); }
double acos(double x) { return Sleef_cinz_acosd1_u10purec(x); }
double atan(double x) { return Sleef_cinz_atand1_u10purec(x); }
double atan2(double y, double x) { return Sleef_cinz_atan2d1_u10purec(y, x); }
double exp(double x) { return Sleef_cinz_expd1_u10purec(x); }
double log(double x) { return Sleef_cinz_logd1_u10purec(x); }
double log10(double x) { return Sleef_cinz_log10d1_u10purec(x); }
double pow(double x, double y) { return Sleef_cinz_powd1_u10purec(x, y); }
double hypot(double x, double y) { return Sleef_cinz_hypotd1_u05purec(x, y); }
}  // namespace det

double angle_between(const Vec3& a, const Vec3& b) {
  return det::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

Quat quat_from_fixed_xyz(const Vec3& angles) {
  const auto x = det::sincos(0.5 * angles.x);
  const auto y = det::sincos(0.5 * angles.y);
  const auto z = det::sincos(0.5 * angles.z);
  const Quat qx(x.cos, x.sin, 0, 0);
  const Quat qy(y.cos, 0, y.sin, 0);
  const Quat qz(z.cos, 0, 0, z.sin);
  return qz * qy * qx;
}

Mat3 cofactor(const Mat3& m) {
  return Mat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
}

Mat4 matrix_from_trs(const Vec3& translation, const Quat& rotation, const Vec3& scale) {
  const Mat3 r = glm::mat3_cast(rotation);
  return Mat4(Vec4(r[0] * scale.x, 0), Vec4(r[1] * scale.y, 0), Vec4(r[2] * scale.z, 0),
              Vec4(translation, 1));
}

Stretch stretch_of(const Mat4& m) {
  double unit = 0;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) unit = std::fmax(unit, std::fabs(m[k][i]));
  if (!(unit > 0)) return {0, 0};
  Vec3 columns[3];
  for (int k = 0; k < 3; ++k) columns[k] = Vec3(m[k]) / unit;
  // one-sided Jacobi: turns pairs of columns until all are orthogonal (Hestenes 1958)
  constexpr int kSweeps = 30;  // converges quadratically, five are usual
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool done = true;
    for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
      const double a = glm::dot(columns[p], columns[p]), b = glm::dot(columns[q], columns[q]);
      const double c = glm::dot(columns[p], columns[q]);
      if (std::fabs(c) <= 0x1p-52 * std::sqrt(a * b)) continue;
      done = false;
      const double half = (b - a) / (2 * c);
      const double t = std::copysign(1.0, half) / (std::fabs(half) + std::sqrt(1 + half * half));
      const double cosine = 1 / std::sqrt(1 + t * t), sine = cosine * t;
      const Vec3 first = cosine * columns[p] - sine * columns[q];
      columns[q] = sine * columns[p] + cosine * columns[q];
      columns[p] = first;
    }
    if (done) break;
  }
  const double x = glm::length(columns[0]), y = glm::length(columns[1]),
               z = glm::length(columns[2]);
  return {unit * std::fmin(x, std::fmin(y, z)), unit * std::fmax(x, std::fmax(y, z))};
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace panwright
