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

// Depth of the nearest surface at a pixel, or around it where it has none itself.
std::vector<double> surface_depths(const DepthImage& image) {
  const long width = image.width, height = image.height;
  std::vector<double> out(image.depth.begin(), image.depth.end());
  parallel_for(image.height, [&](std::size_t row) {
    for (long y = static_cast<long>(row), x = 0; x < width; ++x) {
      double& at = out[static_cast<std::size_t>(y * width + x)];
      if (at > 0 && std::isfinite(at)) continue;
      at = INFINITY;
      for (long j = std::max(y - 1, 0l); j <= std::min(y + 1, height - 1); ++j)
        for (long i = std::max(x - 1, 0l); i <= std::min(x + 1, width - 1); ++i) {
          const double near = image.depth[static_cast<std::size_t>(j * width + i)];
          if (near > 0) at = std::min(at, near);
        }
    }
  });
  return out;
}

// Half the length of the chord of a unit disc, summed from its middle to y: its area.
double area_to(double y) {
  const double t = std::clamp(y, -1.0, 1.0);
  return t * std::sqrt(1 - t * t) + det::asin(t);
}

// Shares of rows and columns that a disc covers, of a pixel whose centre is its own.
class DiscShape {
 public:
  // diameters: pixels
  explicit DiscShape(const Vec2& diameter) {
    // pixels spread light themselves: 1/12 of their squared width on each axis
    const Vec2 squares = diameter * diameter - 4.0 / 3.0;
    small_ = std::min(diameter.x, diameter.y) < kSmallDisc;
    if (small_) {
      sides_ = glm::min(diameter * diameter, Vec2(kSmallDisc * kSmallDisc)) / 32.0;
      reach_ = 1;
      return;
    }
    half_ = 0.5 * glm::sqrt(squares);
    reach_ = static_cast<int>(std::ceil(half_.y - 0.5));
  }

  int reach() const { return reach_; }  // rows above and below

  // Light of a row, of 1, and the half width over which it is even.
  struct Row {
    double light = 0, half_width = 0;
  };
  Row row(int offset) const {
    const double low = std::clamp((offset - 0.5) / half_.y, -1.0, 1.0);
    const double high = std::clamp((offset + 0.5) / half_.y, -1.0, 1.0);
    const double area = area_to(high) - area_to(low);  // of π
    if (!(high > low)) return {};
    return {area / kPi, 0.5 * area / (high - low) * half_.x};
  }

  // Adds a pixel's light to a row of cells by their first differences.
  template <class Add>
  void add(std::size_t x, int offset, const Add& cell) const {
    if (small_) {
      const double down = offset == 0 ? 1 - 2 * sides_.y : sides_.y;
      const double shares[] = {sides_.x, 1 - 2 * sides_.x, sides_.x};
      for (int k = -1; k <= 1; ++k) {
        cell(static_cast<double>(x) + k, down * shares[k + 1]);
        cell(static_cast<double>(x) + k + 1, -down * shares[k + 1]);
      }
      return;
    }
    const Row of = row(offset);
    if (!(of.half_width > 0)) return;
    const double density = 0.5 * of.light / of.half_width;
    const double centre = static_cast<double>(x) + 0.5;
    for (const double side : {-1.0, 1.0}) {
      const double end = centre + side * of.half_width, first = std::floor(end);
      const double part = end - first;
      cell(first, -side * density * (1 - part));
      cell(first + 1, -side * density * part);
    }
  }

 private:
  bool small_ = false;
  Vec2 sides_{0};  // shares of the neighbours, of small discs
  Vec2 half_{0};   // radii
  int reach_ = 0;
};

}  // namespace

double blur_px(const Optics& optics, double focal_px, double depth_m) {
  return 1e-3 * optics.aperture_mm * focal_px * std::fabs(1 / depth_m - 1 / optics.focus_m);
}

void defocus(const Optics& optics, const Vec2& focal_px, DepthImage& image) {
  assert(optics.focus_m > 0 && image.depth.size() * 3 == image.radiance.size());
  const std::size_t width = image.width, height = image.height;
  const std::vector<double> depths = surface_depths(image);
  const std::vector<float> from(image.radiance.begin(), image.radiance.end());
  // rows that the largest disc of each row reaches
  std::vector<int> reach(height, -1);
  parallel_for(height, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const float* rgb = &from[3 * (y * width + x)];
      if (rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0) continue;
      const double blur = blur_px(optics, focal_px.y, depths[y * width + x]);
      reach[y] = std::max(reach[y], static_cast<int>(0.5 * std::min(blur, kMostBlur)) + 1);
    }
  });
  const int farthest = *std::ranges::max_element(reach);
  parallel_for(height, [&](std::size_t y) {
    // differences of neighbouring cells, the first of them left of the image
    std::vector<std::array<double, kBands>> cells(width + 2);
    double most = 0;
    const long last = std::min(static_cast<long>(y) + farthest, static_cast<long>(height) - 1);
    for (long row = std::max(static_cast<long>(y) - farthest, 0l); row <= last; ++row) {
      const auto source = static_cast<std::size_t>(row);
      const int offset = static_cast<int>(static_cast<long>(y) - row);
      if (std::abs(offset) > reach[source]) continue;
      for (std::size_t x = 0; x < width; ++x) {
        const float* rgb = &from[3 * (source * width + x)];
        if (rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0) continue;
        const double depth = depths[source * width + x];
        const DiscShape disc(Vec2(std::min(blur_px(optics, focal_px.x, depth), kMostBlur),
                                  std::min(blur_px(optics, focal_px.y, depth), kMostBlur)));
        if (std::abs(offset) > disc.reach()) continue;
        disc.add(x, offset, [&](double column, double share) {
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
