// Bands in which a part of terrain leads to those below it. Private to terrain.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "terrain/tiles.h"

namespace panwright::terrain::internal {

// Heights of a rectangle of a chart's posts, taken while its rows go by.
class HeightWindow {
 public:
  static constexpr std::uint64_t kMostPosts = std::uint64_t{1} << 27;

  // The rectangle about the places of a band along the border of another chart.
  HeightWindow(const ChartRecord& chart, const ChartRecord& upper, double band);

  std::uint64_t posts() const { return std::uint64_t{width_} * height_; }
  // Takes the chart's next row, from the top. Expects: posts() <= kMostPosts.
  void push(std::span<const float> row);
  // Height of the chart's triangles at a place: where its vertical meets them; NaN: none.
  double at(const LatLon& place) const;

 private:
  // Of a cell: all of its posts.
  bool holds(std::uint32_t x, std::uint32_t y) const {
    return x >= left_ && y >= top_ && x + 1 < left_ + width_ && y + 1 < top_ + height_ &&
           !heights_.empty();
  }
  double height(std::uint32_t x, std::uint32_t y) const {
    return double(heights_[std::size_t{y - top_} * width_ + x - left_]);
  }
  std::optional<double> on_triangle(std::uint32_t x, std::uint32_t y, std::uint32_t which,
                                    const Vec3& up) const;

  ChartRecord chart_;
  Map map_;
  std::uint32_t left_ = 0, top_ = 0, width_ = 0, height_ = 0, next_ = 0;
  std::vector<float> heights_;
};

// Findings of a blend.
struct BlendReport {
  double step = 0;  // metres: largest difference of heights at the border
  double sum = 0, squares = 0;
  std::uint64_t posts = 0;    // of the border, with a height below
  std::uint64_t without = 0;  // with none
};

// Blends rows of a chart into windows of those below it, the first first: the share of its own
// height rises from 0 at its border to 1 at the band's end, as 3t² - 2t³.
class Blend {
 public:
  Blend(const ChartRecord& chart, double band, std::vector<const HeightWindow*> below);

  // Replaces the heights of row `y`; NaN stays.
  void apply(std::uint32_t y, std::span<double> heights);
  const BlendReport& report() const { return report_; }

 private:
  ChartRecord chart_;
  Map map_;
  double band_;
  std::vector<const HeightWindow*> below_;
  BlendReport report_;
};

}  // namespace panwright::terrain::internal
