// Motions of robots as products of elementary matrices in long double, and numbers for their tests.
#pragma once

#include <cmath>
#include <random>

#include "base/math.h"
#include "tests/support/affine_maps.h"

namespace panwright::importers {

using support::Map;
using support::Vector;

// About coordinate axis k.
inline Map turn(std::size_t k, long double angle) {
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  Map out;
  out.m[i][i] = out.m[j][j] = std::cos(angle);
  out.m[j][i] = std::sin(angle);
  out.m[i][j] = -out.m[j][i];
  return out;
}

inline Map roll_pitch_yaw(const Vec3& a) {
  return then(turn(2, a.z), then(turn(1, a.y), turn(0, a.x)));
}

inline Map shift(const Vector& t) {
  Map out;
  out.t = t;
  return out;
}

// About any axis, by turning it to z and back.
inline Map turn_about(const Vec3& axis, long double angle) {
  const long double x = axis.x, y = axis.y, z = axis.z;
  const long double longitude = std::atan2(y, x);
  const long double colatitude = std::atan2(std::sqrt(x * x + y * y), z);
  const Map there = then(turn(2, longitude), turn(1, colatitude));
  const Map back = then(turn(1, -colatitude), turn(2, -longitude));
  return then(there, then(turn(2, angle), back));
}

inline double difference(const Mat4& world, const Map& expected) {
  long double worst = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      worst = std::max(
          worst, std::fabs(world[static_cast<int>(j)][static_cast<int>(i)] - expected.m[i][j]));
    worst = std::max(worst, std::fabs(world[3][static_cast<int>(i)] - expected.t[i]));
  }
  return static_cast<double>(worst);
}

class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : random_(seed) {}
  double operator()(double most) {
    return most * (2 * (static_cast<double>(random_() >> 11) * 0x1p-53) - 1);
  }
  Vec3 vector(double most) { return {(*this)(most), (*this)(most), (*this)(most)}; }

 private:
  std::mt19937_64 random_;
};

}  // namespace panwright::importers
