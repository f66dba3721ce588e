#include "geometry/tessellate/internal/subdiv_rates.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace panwright::geometry::internal {

namespace {

// samples along a side of a cell, of cages of many cells fewer
constexpr std::uint32_t kSamples = 8;
constexpr std::uint32_t kFewSamples = 4;
constexpr std::size_t kManyCells = 4096;

struct Samples {
  std::uint32_t count;
  std::vector<Vec3> positions;  // (count + 1)²
  std::vector<Vec3> normals;

  std::size_t index(std::uint32_t i, std::uint32_t j) const { return j * (count + 1) + i; }
};

Samples sampled(const CellSurface& surface, const Cell& cell, std::uint32_t count) {
  Samples s{count, {}, {}};
  for (std::uint32_t j = 0; j <= count; ++j)
    for (std::uint32_t i = 0; i <= count; ++i) {
      const bool corner = (i == 0 || i == count) && (j == 0 || j == count);
      CornerLimit at;
      if (corner) {
        at = surface.corner(cell, i == 0 ? (j == 0 ? 0 : 3) : (j == 0 ? 1 : 2));
      } else {
        LimitPoint p;
        surface.evaluate(cell, Vec2(i, j) / static_cast<double>(count), p);
        at = {p.position, normal_of(p)};
      }
      s.positions.push_back(at.position);
      s.normals.push_back(at.normal);
    }
  return s;
}

// The part of a second difference that moves the surface, or a curve that is a border of it.
double across_surface(const Vec3& d, const Vec3& normal) {
  return normal == Vec3(0) ? glm::length(d) : std::fabs(glm::dot(d, normal));
}
double across_curve(const Vec3& d, const Vec3& chord) {
  const double squared = glm::dot(chord, chord);
  return squared > 0 ? glm::length(d - glm::dot(d, chord) / squared * chord) : glm::length(d);
}

CellBend bend_of(const CellSurface& surface, const Cell& cell, std::uint32_t n) {
  const Samples s = sampled(surface, cell, n);
  const auto is_curve = [&](std::uint32_t side) {
    return surface.cells().rails[cell.rail[side]].splits;
  };
  const auto second = [&](std::size_t a, std::size_t b, std::size_t c, bool curve) {
    const Vec3 d = s.positions[a] - 2.0 * s.positions[b] + s.positions[c];
    const double on_surface = across_surface(d, s.normals[b]);
    return curve ? std::max(on_surface, across_curve(d, s.positions[c] - s.positions[a]))
                 : on_surface;
  };
  CellBend bend;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 1; i < n; ++i) {
      const bool low = j == 0, high = j == n;
      bend.u = std::max(bend.u, second(s.index(i - 1, j), s.index(i, j), s.index(i + 1, j),
                                       (low && is_curve(0)) || (high && is_curve(2))));
      bend.v = std::max(bend.v, second(s.index(j, i - 1), s.index(j, i), s.index(j, i + 1),
                                       (low && is_curve(3)) || (high && is_curve(1))));
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const Vec3 d = s.positions[s.index(i, j)] - s.positions[s.index(i + 1, j)] -
                     s.positions[s.index(i, j + 1)] + s.positions[s.index(i + 1, j + 1)];
      bend.twist = std::max(bend.twist, across_surface(d, s.normals[s.index(i, j)]));
    }
  const double squared = static_cast<double>(n) * n;
  return {bend.u * squared / 8, bend.v * squared / 8, bend.twist * squared / 4};
}

// What one direction needs beside so many segments in the other.
double beside(double own, double other, double twist, double segments, double tolerance) {
  const double left = tolerance - other / (segments * segments);
  const double c = twist / segments;
  if (!(left > 0)) return kMostSegments + 1.0;
  return (c + std::sqrt(c * c + 4 * own * left)) / (2 * left);
}

double whole(double segments) {
  // a count that is whole but for rounding is that
  return std::clamp(std::ceil(segments - 1e-6), 1.0, kMostSegments + 1.0);
}

struct Rates {
  double u, v;
};

// Fewest u·v with bend.u/u² + bend.v/v² + bend.twist/(u·v) within the tolerance: for a given
// product the first two are least where they are equal.
Rates rates_of(const CellBend& b, double tolerance) {
  const double product = (2 * std::sqrt(b.u) * std::sqrt(b.v) + b.twist) / tolerance;
  if (!(product < 4.0 * kMostSegments * kMostSegments))
    return {kMostSegments + 1.0, kMostSegments + 1.0};
  const double ratio = b.u > 0 && b.v > 0 ? std::sqrt(b.u / b.v)
                       : b.u > 0          ? 1e9
                       : b.v > 0          ? 1e-9
                                          : 1;
  const double u = whole(std::max(1.0, std::sqrt(product * ratio)));
  const double v = whole(std::max(1.0, std::sqrt(product / ratio)));
  const Rates by_u{u, whole(beside(b.v, b.u, b.twist, u, tolerance))};
  const Rates by_v{whole(beside(b.u, b.v, b.twist, v, tolerance)), v};
  return by_u.u * by_u.v <= by_v.u * by_v.v ? by_u : by_v;
}

}  // namespace

std::vector<CellBend> bends_of(const CellSurface& surface) {
  const std::vector<Cell>& cells = surface.cells().cells;
  std::vector<CellBend> bends(cells.size());
  const std::uint32_t samples = cells.size() > kManyCells ? kFewSamples : kSamples;
  constexpr std::size_t kCells = 64;
  parallel_for((cells.size() + kCells - 1) / kCells, [&](std::size_t chunk) {
    for (std::size_t i = chunk * kCells; i < std::min(cells.size(), (chunk + 1) * kCells); ++i)
      bends[i] = bend_of(surface, cells[i], samples);
  });
  return bends;
}

std::vector<std::uint32_t> rates_for(const Cells& cells, const std::vector<CellBend>& bends,
                                     const std::vector<double>& factors, double tolerance) {
  std::vector<std::uint32_t> rates(cells.rails.size(), 1);
  for (std::size_t i = 0; i < cells.cells.size(); ++i) {
    const double f = factors[i];
    const Rates r = rates_of({f * bends[i].u, f * bends[i].v, f * bends[i].twist}, tolerance);
    for (std::uint32_t side = 0; side < 4; ++side) {
      std::uint32_t& rate = rates[cells.cells[i].rail[side]];
      rate = std::max(rate, static_cast<std::uint32_t>(side % 2 == 0 ? r.u : r.v));
    }
  }
  return rates;
}

}  // namespace panwright::geometry::internal
