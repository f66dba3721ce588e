#include "pxn/reader/metric.h"

#include <algorithm>
#include <cmath>

namespace panwright::pxn {

std::array<double, 6> metric_of(const Mat4& m) {
  const Vec3 x(m[0]), y(m[1]), z(m[2]);
  std::array<double, 6> g = {glm::dot(x, x), glm::dot(y, y), glm::dot(z, z),
                             glm::dot(x, y), glm::dot(x, z), glm::dot(y, z)};
  int exponent = 0;
  std::frexp(std::max({g[0], g[1], g[2]}), &exponent);
  // + 0.0: no negative zero in keys
  for (double& part : g)
    part = std::ldexp(std::floor(std::ldexp(part, 36 - exponent) + 0.5), exponent - 36) + 0.0;
  return g;
}

Mat3 metres_of(const std::array<double, 6>& g) {
  const auto root = [](double a) { return a > 0 ? std::sqrt(a) : 0.0; };
  const auto over = [](double a, double b) { return b > 0 ? a / b : 0.0; };
  const double xx = root(g[0]);
  const double xy = over(g[3], xx), xz = over(g[4], xx);
  const double yy = root(g[1] - xy * xy);
  const double yz = over(g[5] - xy * xz, yy);
  const double zz = root(g[2] - xz * xz - yz * yz);
  return {Vec3(xx, 0, 0), Vec3(xy, yy, 0), Vec3(xz, yz, zz)};
}

}  // namespace panwright::pxn
