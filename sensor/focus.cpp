#include "sensor/focus.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include "base/parallel.h"

namespace panwright::sensor {

namespace {

// Discs smaller than this are three by three pixels of the same second moment.
constexpr double kSmallDisc = 2.45;

bool is_surface(float depth) { return depth > 0 && std::isfinite(depth); }

// Gives pixels beyond the edge of a surface its depth, if their light is what the Gaussian of the
// image brings there of it, at most.
class Tails {
 public:
  Tails(const DepthImage& image, std::vector<double>& depths)
      : image_(image),
        depths_(depths),
        reach_(static_cast<long>(std::ceil(kReach * image.psf_px)) + 1),
        nearest_(depths.size(), INFINITY) {}

  void spread() {
    const long width = image_.width, height = image_.height;
    for (long y = 0; y < height; ++y)
      for (long x = 0; x < width; ++x)
        if (is_edge(x, y)) spread(x, y);
  }

 private:
  static constexpr double kReach = 7;  // of the renderer's Gaussian

  std::size_t index(long x, long y) const { return static_cast<std::size_t>(y * image_.width + x); }
  float light(std::size_t i) const {
    return std::max(
        {image_.radiance[3 * i], image_.radiance[3 * i + 1], image_.radiance[3 * i + 2]});
  }

  bool is_edge(long x, long y) const {
    if (!is_surface(image_.depth[index(x, y)])) return false;
    const auto open = [&](long i, long j) {
      return i >= 0 && j >= 0 && i < image_.width && j < image_.height &&
             !is_surface(image_.depth[index(i, j)]);
    };
    return open(x - 1, y) || open(x + 1, y) || open(x, y - 1) || open(x, y + 1);
  }

  template <class Use>
  void around(long x, long y, const Use& use) const {
    for (long j = std::max(y - reach_, 0l); j <= std::min<long>(y + reach_, image_.height - 1); ++j)
      for (long i = std::max(x - reach_, 0l); i <= std::min<long>(x + reach_, image_.width - 1);
           ++i)
        use(index(i, j), static_cast<double>((i - x) * (i - x) + (j - y) * (j - y)));
  }

  void spread(long x, long y) {
    const auto depth = static_cast<double>(image_.depth[index(x, y)]);
    float most = 0;
    around(x, y, [&](std::size_t i, double) {
      if (is_surface(image_.depth[i])) most = std::max(most, light(i));
    });
    around(x, y, [&](std::size_t i, double squares) {
      if (is_surface(image_.depth[i])) return;
      if (squares > nearest_[i] || (squares == nearest_[i] && depth >= depths_[i])) return;
      // an edge is within a pixel of the centre of its last one
      const double beyond = std::max(std::sqrt(squares) - 1, 0.0) / image_.psf_px;
      if (squares > 2 && light(i) > 0.5 * det::exp(-0.5 * beyond * beyond) * double{most}) return;
      nearest_[i] = squares;
      depths_[i] = depth;
    });
  }

  const DepthImage& image_;
  std::vector<double>& depths_;
  long reach_;                   // pixels
  std::vector<double> nearest_;  // squared distance of the edge whose depth a pixel has
};

// Depth of the surface at a pixel, or of the nearest one whose light it has.
std::vector<double> surface_depths(const DepthImage& image) {
  std::vector<double> out(image.depth.begin(), image.depth.end());
  for (double& depth : out)
    if (!(depth > 0)) depth = INFINITY;
  Tails(image, out).spread();
  return out;
}

// Integrals from the middle of a unit disc to y: of half its chord, and of the cube of this.
double half_area(double y) { return 0.5 * (y * std::sqrt(1 - y * y) + det::asin(y)); }
double half_cubes(double y) {
  return (y * (5 - 2 * y * y) * std::sqrt(1 - y * y) + 3 * det::asin(y)) / 8;
}

// Discs are made of these steps in diameter, pixels.
constexpr double kDiscSteps = 128;

// Light of a row of a disc, of 1, and the half width over which it is even: that of its second
// moment.
struct DiscRow {
  double light = 0, half_width = 0;
};

// Disc around the centre of a pixel.
struct Disc {
  std::vector<DiscRow> rows;  // the middle one, and those above and below; empty: not made
  double side = 0;            // of small ones: share of the left and of the right neighbour
  bool is_small() const { return side > 0; }
};

// diameters: pixels
Disc disc_of(const Vec2& diameter) {
  Disc out;
  const Vec2 squares = diameter * diameter;
  if (std::min(diameter.x, diameter.y) < kSmallDisc) {
    const Vec2 sides = glm::min(squares, Vec2(kSmallDisc * kSmallDisc)) / 32.0;
    out.side = std::max(sides.x, 1e-300);
    out.rows = {{1 - 2 * sides.y, 0}, {sides.y, 0}};
    return out;
  }
  // pixels spread light themselves: 1/12 of their squared width on each axis
  const Vec2 half = 0.5 * glm::sqrt(squares - 4.0 / 3.0);
  for (int offset = 0; offset - 0.5 < half.y; ++offset) {
    const double low = std::max((offset - 0.5) / half.y, -1.0);
    const double high = std::min((offset + 0.5) / half.y, 1.0);
    const double area = half_area(high) - half_area(low);  // of a half of π
    if (area > 0)
      out.rows.push_back(
          {2 * area / kPi, half.x * std::sqrt((half_cubes(high) - half_cubes(low)) / area)});
  }
  return out;
}

// Adds a pixel's light to a row of cells by their first differences.
template <class Add>
void add_disc(const Disc& disc, std::size_t x, std::size_t offset, const Add& cell) {
  const DiscRow& row = disc.rows[offset];
  const auto column = static_cast<double>(x);
  if (disc.is_small()) {
    const double side = disc.side * row.light, middle = row.light - 2 * side;
    cell(column - 1, side);
    cell(column, middle - side);
    cell(column + 1, side - middle);
    cell(column + 2, -side);
    return;
  }
  const double density = 0.5 * row.light / row.half_width;
  for (const double side : {-1.0, 1.0}) {
    const double end = column + 0.5 + side * row.half_width, first = std::floor(end);
    const double part = end - first;
    cell(first, -side * density * (1 - part));
    cell(first + 1, -side * density * part);
  }
}

}  // namespace

double blur_px(const Optics& optics, double focal_px, double depth_m) {
  return 1e-3 * optics.aperture_mm * focal_px * std::fabs(1 / depth_m - 1 / optics.focus_m);
}

void defocus(const Optics& optics, const Vec2& focal_px, DepthImage& image) {
  assert(optics.focus_m > 0 && image.depth.size() * 3 == image.radiance.size());
  const std::size_t width = image.width, height = image.height;
  const std::vector<double> depths = surface_depths(image);
  const std::vector<float> from(image.radiance.begin(), image.radiance.end());
  // the disc of each pixel that has light, by its diameter in steps, + 1
  std::vector<std::uint16_t> numbers(width * height);
  constexpr double kMostDiscSteps = kMostBlur * kDiscSteps;
  parallel_for(height, [&](std::size_t y) {
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      if (from[3 * i] == 0 && from[3 * i + 1] == 0 && from[3 * i + 2] == 0) continue;
      const double blur = kDiscSteps * blur_px(optics, focal_px.y, depths[i]);
      numbers[i] = static_cast<std::uint16_t>(std::lround(std::min(blur, kMostDiscSteps)) + 1);
    }
  });
  std::vector<Disc> discs(static_cast<std::size_t>(kMostDiscSteps) + 2);
  std::size_t farthest = 0;
  std::vector<std::size_t> reach(height);  // rows around one that its discs have, + 1
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      if (numbers[i] == 0) continue;
      Disc& disc = discs[numbers[i]];
      const double diameter = (numbers[i] - 1) / kDiscSteps;
      if (disc.rows.empty()) disc = disc_of(Vec2(diameter * focal_px.x / focal_px.y, diameter));
      reach[y] = std::max(reach[y], disc.rows.size());
      farthest = std::max(farthest, reach[y]);
    }
  parallel_for(height, [&](std::size_t y) {
    // differences of neighbouring cells, the first of them left of the image
    std::vector<std::array<double, kBands>> cells(width + 2);
    double most = 0;
    const std::size_t last = std::min(y + farthest, height);
    for (std::size_t row = y - std::min(y, farthest); row < last; ++row) {
      const std::size_t offset = row > y ? row - y : y - row;
      if (offset >= reach[row]) continue;
      for (std::size_t x = 0; x < width; ++x) {
        const Disc& disc = discs[numbers[row * width + x]];
        if (offset >= disc.rows.size()) continue;
        const float* rgb = &from[3 * (row * width + x)];
        add_disc(disc, x, offset, [&](double column, double share) {
          const double at = std::clamp(column + 1, 0.0, static_cast<double>(width) + 1);
          for (std::size_t k = 0; k < kBands; ++k)
            cells[static_cast<std::size_t>(at)][k] += share * double{rgb[k]};
        });
        for (std::size_t k = 0; k < kBands; ++k) most = std::max(most, double{rgb[k]});
      }
    }
    constexpr double kRounding = 1e-12;
    std::array<double, kBands> sum = cells[0];
    for (std::size_t x = 0; x < width; ++x)
      for (std::size_t k = 0; k < kBands; ++k) {
        sum[k] += cells[x + 1][k];
        image.radiance[3 * (y * width + x) + k] =
            sum[k] > kRounding * most ? static_cast<float>(sum[k]) : 0.0f;
      }
  });
}

}  // namespace panwright::sensor
