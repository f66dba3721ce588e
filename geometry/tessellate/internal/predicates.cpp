#include "geometry/tessellate/internal/predicates.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace panwright::geometry::internal {

namespace {

constexpr double kEpsilon = 0x1p-53;

// A sum that loses nothing: components that do not overlap, smallest first.
class Expansion {
 public:
  void add(double term) {
    if (term == 0) return;
    std::size_t kept = 0;
    double carry = term;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = carry + parts_[i];
      const double virtual_part = sum - carry;
      const double lost = (carry - (sum - virtual_part)) + (parts_[i] - virtual_part);
      carry = sum;
      if (lost != 0) parts_[kept++] = lost;
    }
    if (carry != 0) parts_[kept++] = carry;
    size_ = kept;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  int sign() const { return size_ == 0 ? 0 : parts_[size_ - 1] > 0 ? 1 : -1; }

 private:
  std::array<double, 16> parts_;
  std::size_t size_ = 0;
};

// a − b, and what rounding took from it.
struct Difference {
  Difference(double a, double b) : value(a - b) {
    const double b_used = a - value;
    const double a_used = value + b_used;
    rest = (a - a_used) + (b_used - b);
  }
  double value;
  double rest;
};

int exact_orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Difference ax(a.x, c.x), ay(a.y, c.y), bx(b.x, c.x), by(b.y, c.y);
  Expansion sum;
  sum.add_product(ax.rest, by.rest);
  sum.add_product(-ay.rest, bx.rest);
  sum.add_product(ax.rest, by.value);
  sum.add_product(ax.value, by.rest);
  sum.add_product(-ay.rest, bx.value);
  sum.add_product(-ay.value, bx.rest);
  sum.add_product(ax.value, by.value);
  sum.add_product(-ay.value, bx.value);
  return sum.sign();
}

}  // namespace

int orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double left = (a.x - c.x) * (b.y - c.y);
  const double right = (a.y - c.y) * (b.x - c.x);
  const double det = left - right;
  // Shewchuk's bound A
  const double doubt = (3 + 16 * kEpsilon) * kEpsilon * (std::fabs(left) + std::fabs(right));
  if (det > doubt) return 1;
  if (-det > doubt) return -1;
  return exact_orientation(a, b, c);
}

bool clearly_in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d,
                       const Vec3& lift) {
  const Vec2 ad = a - d;
  const Vec2 bd = b - d;
  const Vec2 cd = c - d;
  const double bc0 = bd.x * cd.y, bc1 = cd.x * bd.y;
  const double ca0 = cd.x * ad.y, ca1 = ad.x * cd.y;
  const double ab0 = ad.x * bd.y, ab1 = bd.x * ad.y;
  const double det = lift.x * (bc0 - bc1) + lift.y * (ca0 - ca1) + lift.z * (ab0 - ab1);
  const double size = lift.x * (std::fabs(bc0) + std::fabs(bc1)) +
                      lift.y * (std::fabs(ca0) + std::fabs(ca1)) +
                      lift.z * (std::fabs(ab0) + std::fabs(ab1));
  // Shewchuk's bound is 10 ε for two squares in the lift; three add one rounding
  return det > 12 * kEpsilon * size;
}

}  // namespace panwright::geometry::internal
