// Symmetric 3×3 matrices: eigenvectors and systems of equations.
#pragma once

#include <optional>

#include "base/math.h"

namespace panwright::geometry {

// Unit eigenvectors, the one of the smallest value first: Jacobi's rotations. Expects: symmetric.
Mat3 eigenvectors(Mat3 m);

// The x of m·x = b; nothing where it hangs on rounding. Expects: symmetric, positive semidefinite.
std::optional<Vec3> solved(const Mat3& m, const Vec3& b);

}  // namespace panwright::geometry
