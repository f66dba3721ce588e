#include "scenario/interpolate.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace panwright::scenario {

namespace {

// Coefficients of Newton's form: divided[k] belongs to the product of the first k (time − node).
template <class Value>
Value newton_sum(std::span<const double> nodes, std::span<const Value> divided, double time) {
  Value sum = divided.back();
  for (std::size_t k = divided.size() - 1; k-- > 0;) sum = sum * (time - nodes[k]) + divided[k];
  return sum;
}

template <class Value>
Value lagrange_of(std::span<const double> times, std::span<const Value> values, double time) {
  const std::size_t n = times.size();
  assert(n >= 1 && n <= kMaxNodes && values.size() == n);
  // differences from a node in the middle round less than large values
  const Value middle = values[n / 2];
  std::array<Value, kMaxNodes> divided;
  for (std::size_t i = 0; i < n; ++i) divided[i] = values[i] - middle;
  for (std::size_t order = 1; order < n; ++order)
    for (std::size_t i = n - 1; i >= order; --i)
      divided[i] = (divided[i] - divided[i - 1]) / (times[i] - times[i - order]);
  return middle + newton_sum<Value>(times, std::span(divided).first(n), time);
}

// Vector of half the rotation's angle: det functions keep its bits.
Vec3 rotation_vector(Quat q) {
  if (q.w < 0) q = -q;
  const Vec3 axis(q.x, q.y, q.z);
  const double sine = std::sqrt(dot(axis, axis));
  if (sine == 0) return Vec3(0);
  return axis * (2 * det::atan2(sine, q.w) / sine);
}

Quat rotation_by(const Vec3& vector) {
  const double angle = std::sqrt(dot(vector, vector));
  if (angle < 1e-150) return Quat(1, 0, 0, 0);
  const det::SinCos half = det::sincos(angle / 2);
  const Vec3 axis = vector * (half.sin / angle);
  return Quat(half.cos, axis.x, axis.y, axis.z);
}

// The derivative of a rotation vector whose body turns at a rate in its own axes: the inverse of
// the right Jacobian (Chirikjian, Stochastic Models II, 10.7).
Vec3 vector_rate(const Vec3& vector, const Vec3& rate) {
  const double squared = dot(vector, vector);
  const double angle = std::sqrt(squared);
  double factor = 1.0 / 12;
  if (angle > 1e-3) {
    const det::SinCos half = det::sincos(angle / 2);
    factor = (1 - angle / 2 * half.cos / half.sin) / squared;
  }
  const Vec3 turned = cross(vector, rate);
  return rate + 0.5 * turned + factor * cross(vector, turned);
}

std::size_t interval_of(std::span<const double> times, double time) {
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  const auto at = static_cast<std::size_t>(next - times.begin());
  return std::clamp<std::size_t>(at, 1, times.size() - 1) - 1;
}

// Cubic over one step from values and derivatives at its ends; share in [0, 1].
template <class Value>
Value cubic_step(const Value& a, const Value& b, const Value& da, const Value& db, double step,
                 double s) {
  const double r = 1 - s;
  return a + (b - a) * (s * s * (3 - 2 * s)) + (da * r - db * s) * (step * s * r);
}

// Derivative at one of three nodes of the parabola through them. left, right: mean slopes.
template <class Value>
Value parabola_slope(const Value& left, const Value& right, double before, double after, int node) {
  const Value curve = (right - left) / (before + after);
  if (node == 0) return left - curve * before;
  if (node == 2) return right + curve * after;
  return left + curve * before;
}

template <class Value>
Value slope_of(std::span<const double> times, std::span<const Value> values, std::size_t node) {
  const std::size_t n = times.size();
  if (n < 2) return Value(0);
  const auto mean = [&](std::size_t i) {
    return (values[i + 1] - values[i]) / (times[i + 1] - times[i]);
  };
  if (n == 2) return mean(0);
  const std::size_t middle = std::clamp<std::size_t>(node, 1, n - 2);
  return parabola_slope<Value>(mean(middle - 1), mean(middle), times[middle] - times[middle - 1],
                               times[middle + 1] - times[middle],
                               static_cast<int>(node + 1 - middle));
}

template <class Value>
Value cubic_of(std::span<const double> times, std::span<const Value> values, double time) {
  if (times.size() == 1) return values[0];
  const std::size_t i = interval_of(times, time);
  const double step = times[i + 1] - times[i];
  return cubic_step(values[i], values[i + 1], slope_of<Value>(times, values, i),
                    slope_of<Value>(times, values, i + 1), step, (time - times[i]) / step);
}

// Angular velocity at a node, in its own axes.
Vec3 rate_of(std::span<const double> times, std::span<const Quat> values, std::size_t node) {
  const std::size_t n = times.size();
  const auto mean = [&](std::size_t i) {  // the same in the axes of both ends
    return rotation_vector(conjugate(values[i]) * values[i + 1]) / (times[i + 1] - times[i]);
  };
  if (n == 2) return mean(0);
  const std::size_t middle = std::clamp<std::size_t>(node, 1, n - 2);
  return parabola_slope<Vec3>(mean(middle - 1), mean(middle), times[middle] - times[middle - 1],
                              times[middle + 1] - times[middle],
                              static_cast<int>(node + 1 - middle));
}

}  // namespace

std::size_t first_node(std::span<const double> times, double time, std::size_t count) {
  assert(count >= 1 && count <= times.size());
  if (times.size() == 1) return 0;
  std::size_t at = interval_of(times, time);
  if (count % 2 == 1 && time - times[at] > times[at + 1] - time) ++at;
  const std::size_t before = count % 2 == 1 ? count / 2 : count / 2 - 1;
  return std::min(at > before ? at - before : 0, times.size() - count);
}

Vec3 lagrange(std::span<const double> times, std::span<const Vec3> values, double time) {
  return lagrange_of<Vec3>(times, values, time);
}

Vec4 lagrange(std::span<const double> times, std::span<const Vec4> values, double time) {
  return lagrange_of<Vec4>(times, values, time);
}

Vec3 hermite(std::span<const double> times, std::span<const Vec3> values,
             std::span<const Vec3> derivatives, double time) {
  const std::size_t n = 2 * times.size();
  assert(n >= 2 && n <= kMaxNodes && 2 * values.size() == n && 2 * derivatives.size() == n);
  const Vec3 middle = values[values.size() / 2];
  std::array<double, kMaxNodes> nodes;
  std::array<Vec3, kMaxNodes> divided;
  for (std::size_t i = 0; i < n; ++i) {
    nodes[i] = times[i / 2];
    divided[i] = values[i / 2] - middle;
  }
  for (std::size_t order = 1; order < n; ++order)
    for (std::size_t i = n - 1; i >= order; --i) {
      const bool same = order == 1 && i % 2 == 1;
      divided[i] =
          same ? derivatives[i / 2] : (divided[i] - divided[i - 1]) / (nodes[i] - nodes[i - order]);
    }
  return middle +
         newton_sum<Vec3>(std::span(nodes).first(n), std::span<const Vec3>(divided).first(n), time);
}

Quat slerp(const Quat& a, const Quat& b, double share) {
  if (share == 0) return a;
  const Quat nearer = dot(a, b) < 0 ? -b : b;
  if (share == 1) return nearer;
  return normalize(a * rotation_by(rotation_vector(conjugate(a) * nearer) * share));
}

double slope(std::span<const double> times, std::span<const double> values, std::size_t node) {
  return slope_of<double>(times, values, node);
}

Vec3 slope(std::span<const double> times, std::span<const Vec3> values, std::size_t node) {
  return slope_of<Vec3>(times, values, node);
}

double cubic(std::span<const double> times, std::span<const double> values, double time) {
  return cubic_of<double>(times, values, time);
}

Vec3 cubic(std::span<const double> times, std::span<const Vec3> values, double time) {
  return cubic_of<Vec3>(times, values, time);
}

Quat cubic(std::span<const double> times, std::span<const Quat> values, double time) {
  if (times.size() == 1) return values[0];
  const std::size_t i = interval_of(times, time);
  const double step = times[i + 1] - times[i];
  const Vec3 whole = rotation_vector(conjugate(values[i]) * values[i + 1]);
  const Vec3 vector =
      cubic_step(Vec3(0), whole, rate_of(times, values, i),
                 vector_rate(whole, rate_of(times, values, i + 1)), step, (time - times[i]) / step);
  return normalize(values[i] * rotation_by(vector));
}

}  // namespace panwright::scenario
