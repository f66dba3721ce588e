// Integrals over the hemisphere, independent of the formulas.
#pragma once

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "base/math.h"

namespace panwright::materials {

// Nodes and weights of Gauss-Legendre quadrature on [0, 1], by Newton's method on the polynomial.
inline std::vector<std::pair<double, double>> gauss(int order) {
  std::vector<std::pair<double, double>> nodes;
  for (int i = 0; i < order; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (order + 0.5));
    double slope = 1;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double p = 1, q = 0;
      for (int k = 0; k < order; ++k) {
        const double r = q;
        q = p;
        p = ((2 * k + 1) * x * q - k * r) / (k + 1);
      }
      slope = order * (x * p - q) / (x * x - 1);
      const double step = p / slope;
      x -= step;
      if (std::fabs(step) < 1e-15) break;
    }
    nodes.push_back({0.5 * (1 - x), 1 / ((1 - x * x) * slope * slope)});
  }
  return nodes;
}

inline Vec3 from_angles(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// ∫ f(direction) cos θ dω over the hemisphere about +z. order nodes in θ and in each half of φ.
inline double cosine_integral(const std::function<double(const Vec3&)>& f, int order) {
  const auto nodes = gauss(order);
  double sum = 0;
  for (const auto& [x, wx] : nodes)
    for (const auto& [y, wy] : nodes)
      for (const int half : {0, 1}) {
        const double theta = x * kPi / 2;
        sum += wx * wy * kPi * kPi / 2 * std::cos(theta) * std::sin(theta) *
               f(from_angles(theta, kPi * (y + half)));
      }
  return sum;
}

}  // namespace panwright::materials
