#include "geometry/symmetric.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace panwright::geometry {

Mat3 eigenvectors(Mat3 m) {
  Mat3 v(1);
  for (int sweep = 0; sweep < 32; ++sweep) {
    const double off = std::fabs(m[0][1]) + std::fabs(m[0][2]) + std::fabs(m[1][2]);
    if (!(off > 1e-300)) break;
    for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
      if (m[p][q] == 0) continue;
      const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
      const double t = (theta >= 0 ? 1 : -1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
      const double c = 1 / std::sqrt(t * t + 1), s = t * c;
      Mat3 turn(1);
      turn[p][p] = turn[q][q] = c;
      turn[q][p] = s;
      turn[p][q] = -s;
      m = glm::transpose(turn) * m * turn;
      v = v * turn;
    }
  }
  std::array<int, 3> order{0, 1, 2};
  std::ranges::stable_sort(order, [&](int a, int b) { return m[a][a] < m[b][b]; });
  return {v[order[0]], v[order[1]], v[order[2]]};
}

std::optional<Vec3> solved(const Mat3& m, const Vec3& b) {
  const double scale = m[0][0] + m[1][1] + m[2][2];
  if (!(std::fabs(glm::determinant(m)) > 1e-12 * scale * scale * scale)) return std::nullopt;
  return glm::inverse(m) * b;
}

}  // namespace panwright::geometry
