// Affine maps in long double, independent of the library, to validate kinematics.
#pragma once

#include <array>
#include <cstddef>

namespace panwright::support {

using Vector = std::array<long double, 3>;
struct Map {
  long double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vector t{0, 0, 0};
};

inline Vector apply(const Map& f, const Vector& p) {
  Vector out;
  for (std::size_t i = 0; i < 3; ++i)
    out[i] = f.m[i][0] * p[0] + f.m[i][1] * p[1] + f.m[i][2] * p[2] + f.t[i];
  return out;
}

inline Map then(const Map& outer, const Map& inner) {
  Map out;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      out.m[i][j] = 0;
      for (std::size_t k = 0; k < 3; ++k) out.m[i][j] += outer.m[i][k] * inner.m[k][j];
    }
  out.t = apply(outer, inner.t);
  return out;
}

}  // namespace panwright::support
