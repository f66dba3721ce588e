#include "mli/internal/crease.h"

#include <cmath>

#include "base/math.h"
#include "mli/internal/grid.h"

namespace panwright::mli {
namespace {

constexpr double kLongest = 20;  // lengths

// A normal deviate of two words (Box and Muller).
double normal(std::uint32_t a, std::uint32_t b) {
  return std::sqrt(-2 * det::log(in_unit(a))) * det::cos(2 * kPi * in_unit(b));
}

}  // namespace

double ridge_length(const Crease& crease, const std::array<std::uint32_t, 4>& words) {
  if (in_unit(words[0]) >= crease.tail_share)
    return std::min(kLongest, det::exp(crease.spread * normal(words[1], words[2]))) * crease.length;
  // ∝ L^-tail on [1, kLongest], by its distribution function
  const double power = 1 - crease.tail;
  const double end = det::pow(kLongest, power);
  return crease.length * det::pow(1 - in_unit(words[1]) * (1 - end), 1 / power);
}

double crease_margin(const Crease& crease) { return kLongest / 2 * crease.length; }

double crease_overlap(const Crease& crease) {
  // ∫ x^-p over [1, kLongest]
  const auto integral = [](double p) {
    return std::fabs(p - 1) < 1e-9 ? det::log(kLongest) : (det::pow(kLongest, 1 - p) - 1) / (1 - p);
  };
  const double tail = integral(crease.tail - 2) / integral(crease.tail);
  const double bulk = std::min(kLongest * kLongest, det::exp(2 * crease.spread * crease.spread));
  const double square = crease.tail_share * tail + (1 - crease.tail_share) * bulk;
  // half a length times both reaches, 0.375 lengths each on average
  return 0.375 * crease.length * crease.length * square;
}

namespace {

struct Ridge {
  double x, y;           // middle, metres
  double ex, ey;         // along
  double half;           // length/2
  double apex;           // from the middle, along
  double left, right;    // reach to either side
  double height;         // with its sign
  double y_low, y_high;  // of its facets

  // Height over the sheet at a place, in parts of that of the apex; negative outside.
  double at(double px, double py) const {
    const double dx = px - x, dy = py - y;
    const double u = dx * ex + dy * ey - apex, v = dy * ex - dx * ey;
    return 1 - (u < 0 ? -u / (half + apex) : u / (half - apex)) - (v > 0 ? v / left : -v / right);
  }
};

Ridge ridge_of(const Crease& crease, const Grid& grid, std::uint32_t n) {
  const auto place = grid.words(n, 0), size = grid.words(n, 1), shape = grid.words(n, 2);
  const double margin = crease_margin(crease);
  const double length = ridge_length(crease, size);
  const auto direction = det::sincos(kPi * in_unit(place[2]));
  Ridge ridge;
  ridge.x = in_unit(place[0]) * (grid.width() + 2 * margin) - margin;
  ridge.y = in_unit(place[1]) * (grid.height() + 2 * margin) - margin;
  ridge.ex = direction.cos;
  ridge.ey = direction.sin;
  ridge.half = length / 2;
  ridge.apex = 0.7 * ridge.half * (2 * in_unit(shape[0]) - 1);
  ridge.left = length * (0.15 + 0.45 * in_unit(shape[1]));
  ridge.right = length * (0.15 + 0.45 * in_unit(shape[2]));
  ridge.height = crease.depth * length / crease.length * (shape[3] >> 31 ? 1 : -1);
  // the corners of its outline: two ends, two beside the apex
  const double ya = ridge.y - ridge.ey * ridge.half, yb = ridge.y + ridge.ey * ridge.half;
  const double yc = ridge.y + ridge.ey * ridge.apex;
  const double yl = yc + ridge.ex * ridge.left, yr = yc - ridge.ex * ridge.right;
  ridge.y_low = std::min(std::min(ya, yb), std::min(yl, yr));
  ridge.y_high = std::max(std::max(ya, yb), std::max(yl, yr));
  return ridge;
}

// Whether it reaches the sheet, by its bounds.
bool reaches(const Ridge& ridge, const Grid& grid) {
  const double far = std::max(ridge.half, std::max(ridge.left, ridge.right)) * 1.4142136;
  return ridge.y_high >= 0 && ridge.y_low <= grid.height() && ridge.x + far >= 0 &&
         ridge.x - far <= grid.width();
}

// Adds a ridge to a row. Its outline is convex: columns outside [low, high] are not met.
void add(const Ridge& ridge, const Grid& grid, double y, double* h) {
  double low = ridge.x + ridge.half, high = ridge.x - ridge.half;
  const double corners[4][2] = {
      {-ridge.half, 0}, {ridge.apex, ridge.left}, {ridge.half, 0}, {ridge.apex, -ridge.right}};
  for (int k = 0; k < 4; ++k) {
    const double* a = corners[k];
    const double* b = corners[(k + 1) % 4];
    const double ya = ridge.y + ridge.ey * a[0] + ridge.ex * a[1];
    const double yb = ridge.y + ridge.ey * b[0] + ridge.ex * b[1];
    if ((ya < y) == (yb < y)) continue;
    const double xa = ridge.x + ridge.ex * a[0] - ridge.ey * a[1];
    const double xb = ridge.x + ridge.ex * b[0] - ridge.ey * b[1];
    const double x = xa + (y - ya) / (yb - ya) * (xb - xa);
    low = std::min(low, x);
    high = std::max(high, x);
  }
  const double last = static_cast<double>(grid.columns - 1);
  // one more to either side: what rounds outside adds nothing
  const double from = std::max(0.0, std::floor(low / grid.cell));
  const double to = std::min(last, std::ceil(high / grid.cell));
  if (!(from <= to)) return;
  for (auto i = static_cast<std::size_t>(from); i <= static_cast<std::size_t>(to); ++i) {
    const double part = ridge.at(static_cast<double>(i) * grid.cell, y);
    if (part > 0) h[i] += ridge.height * part;
  }
}

}  // namespace

void apply(const Crease& crease, const Grid& grid, const Job& job) {
  const double margin = crease_margin(crease);
  const double area = (grid.width() + 2 * margin) * (grid.height() + 2 * margin);
  const auto count = static_cast<std::uint32_t>(crease.density * area + 0.5);
  std::vector<Ridge> ridges;
  for (std::uint32_t n = 0; n < count; ++n) {
    const Ridge ridge = ridge_of(crease, grid, n);
    if (reaches(ridge, grid)) ridges.push_back(ridge);
    if (n % 4096 == 0) job.poll();
  }
  for_bands(grid, job, [&](std::size_t first, std::size_t end) {
    const double y0 = static_cast<double>(first) * grid.cell;
    const double y1 = static_cast<double>(end - 1) * grid.cell;
    for (const Ridge& ridge : ridges) {
      if (ridge.y_high < y0 || ridge.y_low > y1) continue;
      for (std::size_t j = first; j < end; ++j) {
        const double y = static_cast<double>(j) * grid.cell;
        if (y >= ridge.y_low && y <= ridge.y_high) add(ridge, grid, y, grid.row(j));
      }
    }
  });
}

}  // namespace panwright::mli
