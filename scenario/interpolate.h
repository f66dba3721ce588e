// Interpolation of samples over time: Newton's divided differences, spherical and cubic curves.
//
// Times ascend strictly. Source of the node windows: CCSDS 502.0-B-3; of divided differences with
// double nodes: Hildebrand, Introduction to Numerical Analysis, 2.6.
#pragma once

#include <cstddef>
#include <span>

#include "base/math.h"

namespace panwright::scenario {

inline constexpr std::size_t kMaxNodes = 32;  // of one polynomial

// Returns the first of `count` nodes around a time: as many before as after it, or with the nearest
// in the middle, shifted at the ends. Expects: count in [1, times.size()]. Cost: O(log n).
std::size_t first_node(std::span<const double> times, double time, std::size_t count);

// Returns the polynomial through n values. Expects: 1 to kMaxNodes of them.
Vec3 lagrange(std::span<const double> times, std::span<const Vec3> values, double time);
Vec4 lagrange(std::span<const double> times, std::span<const Vec4> values, double time);

// The same through n values and their derivatives per second: of degree 2n − 1. Expects: 1 to
// kMaxNodes / 2.
Vec3 hermite(std::span<const double> times, std::span<const Vec3> values,
             std::span<const Vec3> derivatives, double time);

// Returns the rotation at a share of the shorter way from a to b, unit. Expects: unit quaternions.
Quat slerp(const Quat& a, const Quat& b, double share);

// Returns the derivatives of a curve through values: of the parabola through each node and its
// neighbours; at the ends of the same parabola.
double slope(std::span<const double> times, std::span<const double> values, std::size_t node);
Vec3 slope(std::span<const double> times, std::span<const Vec3> values, std::size_t node);

// Returns the cubic curve with such derivatives.
double cubic(std::span<const double> times, std::span<const double> values, double time);
Vec3 cubic(std::span<const double> times, std::span<const Vec3> values, double time);

// The same for unit quaternions: a cubic of the rotation vector from the node before, with
// continuous angular velocity. A constant spin is kept.
Quat cubic(std::span<const double> times, std::span<const Quat> values, double time);

}  // namespace panwright::scenario
