#include "geometry/tessellate/internal/circle.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace panwright::geometry::internal {

namespace {

// sin and cos of an angle; exact at multiples of a quarter turn, whatever the rounding of π
det::SinCos sincos_exact(double angle) {
  const double quarters = angle * (2 / kPi);
  const double nearest = std::round(quarters);
  if (std::fabs(quarters - nearest) > 4e-16 * std::max(1.0, std::fabs(quarters)))
    return det::sincos(angle);
  const double rest = nearest - 4 * std::floor(nearest / 4);
  return turn(static_cast<std::uint64_t>(rest), 4);
}

det::SinCos direction(const Sector& sector, std::uint64_t num, std::uint64_t den) {
  const double span = span_of(sector);
  if (sector.begin == 0 && sector.whole()) return turn(num, den);
  return sincos_exact(sector.begin + span * (static_cast<double>(num) / static_cast<double>(den)));
}

// how far the outline misses a circle of radius 1
double outline_error(double half, bool on_shape) {
  if (on_shape) {
    const double s = det::sin(0.5 * half);
    return 2 * s * s;
  }
  return area_factor(half) - 1;
}

}  // namespace

det::SinCos turn(std::uint64_t k, std::uint64_t n) {
  std::uint64_t num = 4 * k;
  const std::uint64_t den = 4 * n;
  const bool lower = 2 * num > den;
  if (lower) num = den - num;
  const bool left = 4 * num > den;
  if (left) num = den / 2 - num;
  const bool steep = 8 * num > den;
  if (steep) num = den / 4 - num;
  det::SinCos r{std::sqrt(0.5), std::sqrt(0.5)};
  if (8 * num != den)
    r = det::sincos(2 * kPi * (static_cast<double>(num) / static_cast<double>(den)));
  if (steep) std::swap(r.sin, r.cos);
  if (left) r.cos = -r.cos;
  if (lower) r.sin = -r.sin;
  return r;
}

double span_of(const Sector& sector) {
  return sector.whole() ? 2 * kPi : sector.end - sector.begin;
}

std::vector<det::SinCos> directions(const Sector& sector, std::uint32_t segments) {
  std::vector<det::SinCos> result(sector.whole() ? segments : std::size_t{segments} + 1);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = direction(sector, i, segments);
  if (!sector.whole()) result.back() = sincos_exact(sector.end);
  return result;
}

det::SinCos middle_direction(const Sector& sector, std::uint32_t segments, std::uint32_t i) {
  return direction(sector, 2 * std::uint64_t{i} + 1, 2 * std::uint64_t{segments});
}

std::uint32_t fewest_segments(const Sector& sector) {
  // note: a third of a turn as the difference of two rounded angles may be an ulp more
  const double thirds = span_of(sector) * (3 / (2 * kPi)) * (1 - 1e-12);
  return std::max(1u, static_cast<std::uint32_t>(std::ceil(thirds)));
}

double area_factor(double half) { return std::sqrt(2 * half / det::sin(2 * half)); }

std::uint32_t segments_within(double max_error, const Sector& sector, bool on_shape) {
  assert(max_error > 0);
  constexpr double kSaturated = 2147483648.0;
  const std::uint32_t fewest = fewest_segments(sector);
  const double half_span = 0.5 * span_of(sector);
  // 1 − cos h = h²/2 and the factor is 1 + h²/3 to the second order
  const double first = half_span / std::sqrt((on_shape ? 2 : 3) * max_error);
  if (!(first < 1e8)) return static_cast<std::uint32_t>(kSaturated);
  auto n = std::max(fewest, static_cast<std::uint32_t>(first));
  while (outline_error(half_span / n, on_shape) > max_error) ++n;
  while (n > fewest && outline_error(half_span / (n - 1), on_shape) <= max_error) --n;
  return n;
}

}  // namespace panwright::geometry::internal
