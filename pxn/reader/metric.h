// How a matrix stretches space, whatever its turn.
#pragma once

#include <array>

#include "base/math.h"

namespace panwright::pxn {

// MᵀM of a matrix's linear part M: xx, yy, zz, xy, xz, yz. Rounded to 2^-36 of the largest, so that
// turned instances of a shape share one.
std::array<double, 6> metric_of(const Mat4& m);

// The upper triangular matrix with that metric: positions in metres, but for a turn (Cholesky).
// Zero columns where the metric is flat.
Mat3 metres_of(const std::array<double, 6>& metric);

}  // namespace panwright::pxn
