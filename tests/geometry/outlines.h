// Outlines with known triangulations and faults.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/tessellate/internal/outline.h"
#include "shapes.h"

namespace panwright::geometry::shapes {

struct Outline {
  std::vector<Vec2> points;
  std::vector<std::uint32_t> loops{0};

  void add(const std::vector<Vec2>& loop) {
    points.insert(points.end(), loop.begin(), loop.end());
    loops.push_back(static_cast<std::uint32_t>(points.size()));
  }
  internal::Region region() const { return internal::region_of(points, loops); }
};

inline Outline outline(const std::vector<Vec2>& loop) {
  Outline result;
  result.add(loop);
  return result;
}

inline std::vector<Vec2> circle(int count, double radius, const Vec2& centre = Vec2(0)) {
  std::vector<Vec2> loop;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * i / count;
    loop.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return loop;
}

// Rays at growing angles with random lengths.
inline std::vector<Vec2> star(int count, std::uint64_t seed, double least = 0.1) {
  Random random(seed);
  std::vector<Vec2> loop;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * (i + 0.9 * random()) / count;
    loop.push_back(random.between(least, 1) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return loop;
}

// Teeth of height 1 on a back.
inline std::vector<Vec2> comb(int teeth) {
  std::vector<Vec2> loop;
  for (int i = 0; i < teeth; ++i) {
    loop.push_back({2.0 * i, 0});
    loop.push_back({2.0 * i + 1, 1e3});
  }
  loop.push_back({2.0 * teeth, 0});
  loop.push_back({2.0 * teeth, -1});
  loop.push_back({0, -1});
  return loop;
}

// A corridor that winds inwards.
inline std::vector<Vec2> spiral(int count, double turns) {
  std::vector<Vec2> loop;
  const auto at = [&](int i, double shift) {
    const double t = static_cast<double>(i) / (count - 1);
    const double angle = 2 * M_PI * turns * t;
    const double radius = 1 + turns * t + shift;
    return radius * Vec2(std::cos(angle), std::sin(angle));
  };
  for (int i = 0; i < count; ++i) loop.push_back(at(i, 0));
  for (int i = count; i-- > 0;) loop.push_back(at(i, 0.5));
  return loop;
}

inline Outline sieve(int side) {
  Outline result;
  const double size = side;
  result.add({{0, 0}, {size, 0}, {size, size}, {0, size}});
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) result.add(circle(5 + (i + j) % 4, 0.4, {i + 0.5, j + 0.5}));
  return result;
}

// Twice the area of a loop, positive when it runs counter-clockwise.
inline double double_area(const std::vector<Vec2>& points, std::uint32_t begin, std::uint32_t end) {
  long double sum = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const Vec2 p = points[i] - points[begin];
    const Vec2 q = points[i + 1 < end ? i + 1 : begin] - points[begin];
    sum += static_cast<long double>(p.x) * q.y - static_cast<long double>(q.x) * p.y;
  }
  return static_cast<double>(sum);
}

inline double area(const Outline& outline) {
  double sum = 0;
  for (std::size_t l = 0; l + 1 < outline.loops.size(); ++l) {
    const double loop =
        0.5 * std::fabs(double_area(outline.points, outline.loops[l], outline.loops[l + 1]));
    sum += l == 0 ? loop : -loop;
  }
  return sum;
}

// Returns true if a point lies in the area, by crossings of a ray to the right.
inline bool inside(const Outline& outline, const Vec2& p) {
  bool in = false;
  for (std::size_t l = 0; l + 1 < outline.loops.size(); ++l) {
    const std::uint32_t begin = outline.loops[l], end = outline.loops[l + 1];
    for (std::uint32_t i = begin; i < end; ++i) {
      const Vec2& a = outline.points[i];
      const Vec2& b = outline.points[i + 1 < end ? i + 1 : begin];
      if ((a.y > p.y) == (b.y > p.y)) continue;
      if (a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) > p.x) in = !in;
    }
  }
  return in;
}

}  // namespace panwright::geometry::shapes
