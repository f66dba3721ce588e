#include "exporters/internal/cell_pattern.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"
#include "materials/cells.h"

namespace panwright::exporters {

namespace {

constexpr double kMostCells = 512;  // a side that a texture is drawn of
constexpr std::uint32_t kCellTexels = 32, kFewestTexels = 256, kMostTexels = 2048;  // a side

std::uint32_t side(double cells) {
  const std::uint32_t texels = std::bit_ceil(static_cast<std::uint32_t>(cells)) * kCellTexels;
  return std::clamp(texels, kFewestTexels, kMostTexels);
}

Vec3 shares_at(const materials::Cells& cells, const Vec2& texcoord, const Vec2& footprint) {
  const materials::CellShares shares = materials::cells_at(cells, texcoord, footprint);
  return {shares.cell, shares.finger, shares.gap};
}

}  // namespace

CellPattern::CellPattern(const materials::Cells& cells, bool drawn)
    : mean_(shares_at(cells, Vec2(0), 1e3 / cells.count)) {
  const bool whole = cells.count == glm::floor(cells.count) &&
                     std::max(cells.count.x, cells.count.y) <= kMostCells;
  if (!drawn || !whole) return;
  width_ = side(cells.count.x);
  height_ = side(cells.count.y);
  rgba_.resize(std::size_t{4} * width_ * height_);
  const Vec2 size(1.0 / width_, 1.0 / height_);
  parallel_for(height_, [&](std::size_t y) {
    for (std::size_t x = 0; x < width_; ++x) {
      const Vec2 middle((static_cast<double>(x) + 0.5) * size.x,
                        1 - (static_cast<double>(y) + 0.5) * size.y);
      const Vec3 shares = shares_at(cells, middle, size) * 255.0;
      std::uint8_t* texel = &rgba_[4 * (y * width_ + x)];
      for (int k = 0; k < 3; ++k) texel[k] = static_cast<std::uint8_t>(shares[k] + 0.5);
      texel[3] = 255;
    }
  });
}

Vec3 CellPattern::shares(const Vec4& texel) const {
  if (!drawn()) return mean_;
  return Vec3(texel) / std::max(texel.x + texel.y + texel.z, 1e-6);
}

std::vector<Vec3> CellPattern::parts() const {
  if (!drawn()) return {mean_};
  return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
}

}  // namespace panwright::exporters
