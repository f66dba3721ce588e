// Symmetric 3×3 matrices: eigenvectors and linear systems.
#pragma once

#include <optional>

#include "base/math.h"

namespace panwright::geometry {

// Returns unit eigenvectors, the one of the smallest value first: Jacobi's rotations. Expects:
// symmetric.
Mat3 eigenvectors(Mat3 m);

// Solves m·x = b; nothing if ill-conditioned. Expects: symmetric, positive semidefinite.
std::optional<Vec3> solved(const Mat3& m, const Vec3& b);

}  // namespace panwright::geometry
