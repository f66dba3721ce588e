// Slopes of a chart that its coarser triangles leave out.
#include <algorithm>
#include <cmath>

#include "terrain/internal/chart_surface.h"

namespace panwright::terrain::internal {

SlopeSums ChartSurface::fine_slopes(const GroundPoint& point) const {
  constexpr std::uint32_t kMost = (1u << kSlopeLevel) + 3;
  float heights[kMost * kMost];
  const std::uint32_t side = 2u << point.level;
  const std::uint32_t left = point.column / 2 * side, top = point.row / 2 * side;
  const std::uint32_t right = std::min(left + side, record_->width - 1),
                      bottom = std::min(top + side, record_->height - 1);
  // with a post more on each side, for the slopes of those at the border
  const std::uint32_t x0 = left > 0 ? left - 1 : 0, y0 = top > 0 ? top - 1 : 0;
  const std::uint32_t x1 = std::min(right + 1, record_->width - 1),
                      y1 = std::min(bottom + 1, record_->height - 1);
  const std::uint32_t across = level_side(record_->width, 0).tiles,
                      down = level_side(record_->height, 0).tiles;
  std::optional<TileView> view;
  std::uint32_t held = std::numeric_limits<std::uint32_t>::max();
  float* out = heights;
  for (std::uint32_t y = y0; y <= y1; ++y)
    for (std::uint32_t x = x0; x <= x1; ++x) {
      const std::uint32_t tx = std::min(x / kTileCells, across - 1),
                          ty = std::min(y / kTileCells, down - 1);
      const std::uint32_t tile = first_[0] + ty * across + tx;
      if (tile != held) view = tiles_->view(held = tile);
      *out++ = view ? static_cast<float>(height_of(*view, x - tx * kTileCells, y - ty * kTileCells))
                    : std::numeric_limits<float>::quiet_NaN();
    }
  const Vec2 size = map_.spacing(0.5 * (left + right) + 0.5, 0.5 * (top + bottom) + 0.5);
  return slopes_within(heights, x1 - x0 + 1, y1 - y0 + 1,
                       {left - x0, top - y0, right - left, bottom - top}, Vec2(1) / size);
}

// As Map::spacing(), of a post.
Vec2 ChartSurface::spacing_at(PostIndex index) const {
  if (map_.kind == Map::Kind::cylindrical)
    return {record_->dx * std::fabs(rows_[index.row].y) * scale_, record_->dy};
  return map_.spacing(index.column + 0.5, index.row + 0.5);
}

std::optional<SlopeMoments> ChartSurface::stored_slopes(std::uint32_t level, std::uint32_t column,
                                                        std::uint32_t row) const {
  const std::uint32_t across = level_side(record_->width, level).tiles;
  const auto view = tiles_->view(first_[level] + row / kTileCells * across + column / kTileCells);
  if (!view || view->slopes.empty()) return {};
  const std::uint32_t x = column % kTileCells / 2, y = row % kTileCells / 2;
  const SlopeBlock& block = view->slopes[y * kSlopeBlocks + x];
  if (block.p == kNoSlope) return {};
  return moments_of(block, view->slope_unit);
}

// Of the last level without blocks, from a block of the next, which is of four: means by the
// level's own posts, and what these leave of the block's covariance, so that the four together have
// the block's moments. Finer tiles are not looked at: they are sixteen times the bytes.
std::optional<SlopeMoments> ChartSurface::split_slopes(const GroundPoint& point) const {
  constexpr std::uint32_t kLevel = kSlopeLevel - 1, kCells = 4;
  if (!is_large_ || point.level != kLevel || record_->levels <= kSlopeLevel) return {};
  const std::uint32_t x0 = point.column / kCells * kCells, y0 = point.row / kCells * kCells;
  // of whole cells alone
  if ((x0 + kCells) << kLevel > record_->width - 1 || (y0 + kCells) << kLevel > record_->height - 1)
    return {};
  const auto block = stored_slopes(kSlopeLevel, point.column / 2, point.row / 2);
  const std::uint32_t tx = point.column / kTileCells, ty = point.row / kTileCells;
  const auto view =
      tiles_->view(first_[kLevel] + ty * level_side(record_->width, kLevel).tiles + tx);
  if (!block || !view) return {};
  double heights[kCells + 1][kCells + 1];
  for (std::uint32_t j = 0; j <= kCells; ++j)
    for (std::uint32_t i = 0; i <= kCells; ++i)
      heights[j][i] = height_of(*view, x0 + i - tx * kTileCells, y0 + j - ty * kTileCells);
  const double unit = 1 << kLevel;
  const Vec2 apart = 2 * unit * spacing_at({(x0 + 2) << kLevel, (y0 + 2) << kLevel});
  Vec2 means[2][2], all(0);
  for (std::uint32_t j = 0; j < 2; ++j)
    for (std::uint32_t i = 0; i < 2; ++i) {
      const auto along = [&](std::uint32_t k) {
        return Vec2(heights[2 * j + k][2 * i + 2] - heights[2 * j + k][2 * i],
                    heights[2 * j + 2][2 * i + k] - heights[2 * j][2 * i + k]);
      };
      means[j][i] = (0.25 * along(0) + 0.5 * along(1) + 0.25 * along(2)) / apart;
      all += 0.25 * means[j][i];
    }
  Vec2 squares(0);
  double product = 0;
  for (auto& row : means)
    for (Vec2& mean : row) {
      mean -= all;
      squares += 0.25 * mean * mean;
      product += 0.25 * mean.x * mean.y;
    }
  if (!std::isfinite(squares.x + squares.y)) return {};
  double share = 1;
  if (squares.x > block->pp) share = std::min(share, block->pp / squares.x);
  if (squares.y > block->qq) share = std::min(share, block->qq / squares.y);
  const Vec2 off = std::sqrt(share) * means[point.row % kCells / 2][point.column % kCells / 2];
  SlopeMoments out{block->p + off.x, block->q + off.y, block->pp - share * squares.x,
                   block->qq - share * squares.y, 0};
  const double most = std::sqrt(out.pp * out.qq);
  out.pq = std::clamp(block->pq - share * product, -most, most);
  return out;
}

GroundRelief ChartSurface::relief(const GroundPoint& point) const {
  GroundRelief out;
  if (point.level == 0) return out;
  std::optional<SlopeMoments> found;
  if (point.level >= kSlopeLevel)
    found = stored_slopes(point.level, point.column, point.row);
  else if (!(found = split_slopes(point)))
    if (const SlopeSums sums = fine_slopes(point); sums.cells > 0) found = moments_of(sums);
  if (!found) return out;
  const SlopeMoments& moments = *found;
  const std::uint32_t w = record_->width, h = record_->height;
  const PostIndex here{std::min(point.column << point.level, w - 1),
                       std::min(point.row << point.level, h - 1)};
  // the posts of the cell, of level 0
  const PostIndex there{std::min((point.column + 1) << point.level, w - 1),
                        std::min((point.row + 1) << point.level, h - 1)};
  const Vec3 right = post({there.column, here.row}, 0) - post(here, 0);
  const Vec3 up = is_plane() ? Vec3(0, 0, 1) : glm::normalize(point.position);
  const Vec3 across = right - glm::dot(right, up) * up;
  const double length = std::sqrt(glm::dot(across, across));
  if (!(length > 0)) return out;  // at a pole
  out.up = up;
  out.right = across / length;
  // rows go down the map: right, down and up are left-handed
  out.down = glm::cross(out.right, up);
  out.p = moments.p;
  out.q = moments.q;
  out.pp = moments.pp;
  out.qq = moments.qq;
  out.pq = moments.pq;
  return out;
}

}  // namespace panwright::terrain::internal
