#include "light/map_rows.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "image/srgb.h"

namespace panwright::light {
namespace {

const std::array<float, 256>& linear_codes() {
  static const std::array<float, 256> codes = [] {
    std::array<float, 256> out{};
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = static_cast<float>(image::srgb_decoded(static_cast<std::uint8_t>(i)));
    return out;
  }();
  return codes;
}

// Bilinear, of a place in parts of the map.
Vec3 pixel_at(const MapPixels& map, double u, double v) {
  const double x = u * map.width - 0.5, y = v * map.height - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  Vec3 sum(0);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const double column = left + i, row = std::clamp(top + j, 0.0, map.height - 1.0);
      const double wrapped =
          column < 0 ? column + map.width : (column >= map.width ? column - map.width : column);
      const std::size_t at =
          3 * (static_cast<std::size_t>(row) * map.width + static_cast<std::size_t>(wrapped));
      const double weight = (i ? x - left : 1 - (x - left)) * (j ? y - top : 1 - (y - top));
      for (int k = 0; k < 3; ++k) sum[k] += weight * map.rgb[at + static_cast<std::size_t>(k)];
    }
  return sum;
}

}  // namespace

MapRows::MapRows(std::uint32_t width, std::uint32_t height, MapValues values, std::uint32_t turn,
                 std::optional<std::uint8_t> no_data)
    : width_(width),
      height_(height),
      step_((width + kMostWidth - 1) / kMostWidth),
      turn_(turn % width),
      values_(values),
      no_data_(no_data) {
  assert(height > 0 && width == 2 * height);
  sums_.width = std::max(1u, width / step_);
  sums_.height = std::max(1u, height / step_);
  counts_.resize(std::size_t{sums_.width} * sums_.height);
  sums_.rgb.resize(3 * counts_.size());
}

void MapRows::add(std::span<const std::uint8_t> rgba) {
  assert(row_ < height_ && rgba.size() == std::size_t{4} * width_);
  const std::array<float, 256>& linear = linear_codes();
  // what is left over at the end joins the last block
  const std::uint32_t line = std::min(row_ / step_, sums_.height - 1);
  for (std::uint32_t column = 0; column < width_; ++column) {
    const std::uint8_t* code = &rgba[std::size_t{4} * column];
    const bool hole =
        (values_ == MapValues::colour && code[3] == 0) ||
        (no_data_ && code[0] == *no_data_ && code[1] == *no_data_ && code[2] == *no_data_);
    if (hole) {
      if (holes_++ == 0) first_ = Hole{column, row_};
      continue;
    }
    const std::uint32_t east = column + turn_ < width_ ? column + turn_ : column + turn_ - width_;
    const std::size_t at =
        std::size_t{line} * sums_.width + std::min(east / step_, sums_.width - 1);
    counts_[at] += 1;
    float* sum = &sums_.rgb[3 * at];
    if (values_ == MapValues::colour) {
      for (int k = 0; k < 3; ++k) sum[k] += linear[code[k]];
    } else {
      const float share =
          static_cast<float>((code[0] + code[1] + code[2]) * code[3]) / (3 * 255.0f * 255.0f);
      for (int k = 0; k < 3; ++k) sum[k] += share;
    }
  }
  ++row_;
}

MapPixels MapRows::pixels() const {
  MapPixels map = sums_;
  Vec3 sum(0);
  double weights = 0;
  for (std::uint32_t row = 0; row < map.height; ++row) {
    const double weight = det::sin(kPi * (row + 0.5) / map.height);
    for (std::uint32_t column = 0; column < map.width; ++column) {
      const std::size_t at = std::size_t{row} * map.width + column;
      if (counts_[at] == 0) continue;
      weights += weight;
      for (int k = 0; k < 3; ++k) {
        float& value = map.rgb[3 * at + static_cast<std::size_t>(k)];
        value /= counts_[at];
        sum[k] += weight * value;
      }
    }
  }
  if (holes_ == 0) return map;
  const Vec3 mean = weights > 0 ? sum / weights : Vec3(0);
  for (std::size_t at = 0; at < counts_.size(); ++at)
    if (counts_[at] == 0)
      for (int k = 0; k < 3; ++k)
        map.rgb[3 * at + static_cast<std::size_t>(k)] = static_cast<float>(mean[k]);
  return map;
}

Vec3 mean_of(const MapPixels& map) {
  Vec3 sum(0);
  double weights = 0;
  for (std::uint32_t row = 0; row < map.height; ++row) {
    const double weight = det::sin(kPi * (row + 0.5) / map.height);
    Vec3 line(0);
    const float* rgb = &map.rgb[std::size_t{3} * row * map.width];
    for (std::size_t i = 0; i < map.width; ++i, rgb += 3) line += Vec3(rgb[0], rgb[1], rgb[2]);
    sum += weight * line;
    weights += weight * map.width;
  }
  return sum / weights;
}

MapPixels with_clouds(const MapPixels& ground, const MapPixels& clouds, const Vec3& albedo,
                      bool& dimmed) {
  const bool plain = ground.rgb.empty();
  MapPixels both;
  both.width = std::max(ground.width, clouds.width);
  both.height = std::max(ground.height, clouds.height);
  both.rgb.resize(std::size_t{3} * both.width * both.height);
  const auto place = [&](std::size_t i) {
    return Vec2((static_cast<double>(i % both.width) + 0.5) / both.width,
                (static_cast<double>(i / both.width) + 0.5) / both.height);
  };
  const std::size_t count = std::size_t{both.width} * both.height;
  const auto put = [&](std::size_t i, const Vec3& value) {
    for (int k = 0; k < 3; ++k)
      both.rgb[3 * i + static_cast<std::size_t>(k)] = static_cast<float>(value[k]);
  };
  const auto ground_at = [&](const Vec2& at) {
    return plain ? Vec3(1) : pixel_at(ground, at.x, at.y);
  };
  // the ground that the clouds leave
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 at = place(i);
    put(i, (1 - pixel_at(clouds, at.x, at.y).x) * ground_at(at));
  }
  const Vec3 open = mean_of(both), cloud = kCloud * mean_of(clouds);
  const Vec3 left = albedo - cloud;
  dimmed = left.x < 0 || left.y < 0 || left.z < 0;
  Vec3 scale(0), white(kCloud);
  for (int k = 0; k < 3; ++k) {
    if (left[k] >= 0)
      scale[k] = open[k] > 0 ? left[k] / open[k] : 0;
    else
      white[k] *= albedo[k] / cloud[k];
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 at = place(i);
    const double share = pixel_at(clouds, at.x, at.y).x;
    put(i, (1 - share) * scale * ground_at(at) + share * white);
  }
  return both;
}

}  // namespace panwright::light
