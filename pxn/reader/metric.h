// Rotation-invariant stretch of a matrix.
#pragma once

#include <array>

#include "base/math.h"

namespace panwright::pxn {

// Returns MᵀM of a matrix's linear part M: xx, yy, zz, xy, xz, yz. Rounded to 2^-36 of the largest,
// so that rotated instances of a shape share one.
std::array<double, 6> metric_of(const Mat4& m);

// Returns the upper triangular matrix with that metric: positions in metres, up to a rotation
// (Cholesky). Zero columns for a flat metric.
Mat3 metres_of(const std::array<double, 6>& metric);

}  // namespace panwright::pxn
