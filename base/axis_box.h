// Axis-aligned boxes and rectangles.
#pragma once

#include <algorithm>
#include <limits>

#include "base/math.h"

namespace panwright {

// Axis-aligned box of points of two or three coordinates; default: empty.
template <class Point>
struct AxisAligned {
  Point low{std::numeric_limits<double>::infinity()};
  Point high{-std::numeric_limits<double>::infinity()};

  bool empty() const {
    for (int k = 0; k < Point::length(); ++k)
      if (!(low[k] <= high[k])) return true;
    return false;
  }
  // Coordinates that are not numbers are ignored.
  void add(const Point& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  void add(const AxisAligned& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  void widen(double by) {
    low -= by;
    high += by;
  }
  // Returns true if another box comes within a distance along every axis; an empty one never does.
  bool meets(const AxisAligned& other, double within = 0) const {
    for (int k = 0; k < Point::length(); ++k)
      if (!(low[k] <= other.high[k] + within && other.low[k] <= high[k] + within)) return false;
    return true;
  }

  // Expects of the others: not empty. Halves are added, so that huge numbers do not overflow.
  Point centre() const { return 0.5 * low + 0.5 * high; }
  Point extent() const { return high - low; }
  double diagonal() const { return glm::length(extent()); }
  // Returns the longest side; 0: empty.
  double longest() const {
    double longest = 0;
    for (int k = 0; k < Point::length(); ++k) longest = std::max(longest, high[k] - low[k]);
    return longest;
  }
};

using AxisBox = AxisAligned<Vec3>;
using AxisRectangle = AxisAligned<Vec2>;

}  // namespace panwright
