#include <cmath>
#include <utility>

#include "scene/scene.h"

namespace panwright::scene {

namespace {

// radians: axes of a matrix of single precision are off by this much at most
constexpr double kRightAngle = 3e-7;
constexpr double kFlat = 1e-12;  // of the largest stretch

// Columns made orthogonal by turning pairs of them (Hestenes 1958): on return m = U·Σ, and the
// rotation is V with given·V = m.
Mat3 orthogonalised(Mat3& m) {
  Mat3 v(1);
  constexpr int kSweeps = 30;  // converges quadratically, five are usual
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool done = true;
    for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
      const double a = glm::dot(m[p], m[p]), b = glm::dot(m[q], m[q]), c = glm::dot(m[p], m[q]);
      if (std::fabs(c) <= 0x1p-52 * std::sqrt(a * b)) continue;
      done = false;
      const double half = (b - a) / (2 * c);
      const double t = std::copysign(1.0, half) / (std::fabs(half) + std::sqrt(1 + half * half));
      const double cosine = 1 / std::sqrt(1 + t * t), sine = cosine * t;
      for (Mat3* matrix : {&m, &v}) {
        const Vec3 first = cosine * (*matrix)[p] - sine * (*matrix)[q];
        (*matrix)[q] = sine * (*matrix)[p] + cosine * (*matrix)[q];
        (*matrix)[p] = first;
      }
    }
    if (done) break;
  }
  return v;
}

bool right_angled(const Mat3& m) {
  for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)})
    if (std::fabs(glm::dot(m[p], m[q])) > kRightAngle * glm::length(m[p]) * glm::length(m[q]))
      return false;
  return true;
}

}  // namespace

std::optional<Decomposed> decomposed(const Mat4& matrix) {
  double unit = 0;
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < 4; ++i)
      if (!std::isfinite(matrix[k][i])) return std::nullopt;
  if (matrix[0].w != 0 || matrix[1].w != 0 || matrix[2].w != 0 || matrix[3].w != 1)
    return std::nullopt;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) unit = std::fmax(unit, std::fabs(matrix[k][i]));
  if (!(unit > 0)) return std::nullopt;
  Mat3 m;
  for (int k = 0; k < 3; ++k) m[k] = Vec3(matrix[k]) / unit;

  Decomposed out;
  out.sheared = !right_angled(m);
  if (out.sheared) {
    const Mat3 v = orthogonalised(m);
    out.inner.rotation = glm::normalize(glm::conjugate(glm::quat_cast(v)));
  }
  Vec3 scale(glm::length(m[0]), glm::length(m[1]), glm::length(m[2]));
  const double largest = std::fmax(scale.x, std::fmax(scale.y, scale.z));
  if (!(std::fmin(scale.x, std::fmin(scale.y, scale.z)) > kFlat * largest)) return std::nullopt;
  Mat3 axes(m[0] / scale.x, m[1] / scale.y, m[2] / scale.z);
  if (glm::determinant(axes) < 0) {
    axes[2] = -axes[2];
    scale.z = -scale.z;
  }
  out.outer.translation = Vec3(matrix[3]);
  out.outer.rotation = glm::normalize(glm::quat_cast(axes));
  out.outer.scale = scale * unit;
  if (!panwright::is_finite(out.outer.scale)) return std::nullopt;
  return out;
}

}  // namespace panwright::scene
