#include "terrain/internal/tile_levels.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/parallel.h"

namespace panwright::terrain::internal {

// Posts of a tile that is complete: nx · ny of them, rows `pitch` apart.
struct TileLevels::Block {
  const float* posts;
  std::size_t pitch;
  std::uint32_t nx, ny;
  std::uint32_t x0, y0;  // of the level
  std::uint32_t voids;
  float at(std::uint32_t x, std::uint32_t y) const { return posts[y * pitch + x]; }
};

namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

// Largest distance of posts from the two triangles of one coarse cell, whose diagonal runs from the
// first corner to the last. u, v: places of columns and rows in the cell, 0 to 1.
struct Cell {
  float z00, z10, z01, z11;

  // One row of posts; `split`: the first column right of the diagonal.
  float row(const float* posts, const float* u, std::size_t n, std::size_t split, float v,
            bool voids) const {
    const float below = v * (z01 - z00), below_rise = z11 - z01;
    const float above = v * (z11 - z10), above_rise = z10 - z00;
    float most = 0;
    if (!voids) {
      for (std::size_t i = 0; i < split; ++i) {
        const float e = std::fabs((posts[i] - z00) - (below + u[i] * below_rise));
        most = e > most ? e : most;
      }
      for (std::size_t i = split; i < n; ++i) {
        const float e = std::fabs((posts[i] - z00) - (above + u[i] * above_rise));
        most = e > most ? e : most;
      }
      return most;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const float z = i < split ? below + u[i] * below_rise : above + u[i] * above_rise;
      const float e = std::fabs((posts[i] - z00) - z);
      if (std::isnan(e)) {
        // void in both is no difference
        if (std::isnan(z + z00) != std::isnan(posts[i])) return kInfinite;
        continue;
      }
      most = e > most ? e : most;
    }
    return most;
  }
};

void encode(const float* posts, std::size_t pitch, std::uint32_t nx, std::uint32_t ny, double step,
            TileRecord& record, std::vector<std::byte>& bytes) {
  constexpr std::size_t kCount = std::size_t{kTilePosts} * kTilePosts;
  float low = kInfinite, high = -kInfinite;
  for (std::uint32_t y = 0; y < ny; ++y)
    for (std::uint32_t x = 0; x < nx; ++x) {
      const float z = posts[y * pitch + x];
      low = z < low ? z : low;
      high = z > high ? z : high;
    }
  const bool codes = step > 0 && (double(high) - double(low)) / step <= kVoidCode - 1;
  record.form = static_cast<std::uint32_t>(codes ? TileForm::codes : TileForm::floats);
  if (!codes) {
    std::vector<float> all(kCount, std::numeric_limits<float>::quiet_NaN());
    for (std::uint32_t y = 0; y < ny; ++y)
      std::copy_n(posts + y * pitch, nx, all.data() + y * std::size_t{kTilePosts});
    const auto raw = std::as_bytes(std::span(all));
    bytes.assign(raw.begin(), raw.end());
    return;
  }
  // exact: both are multiples of the step, which is a power of two
  const double base = double(low) / step;
  record.base = static_cast<std::int32_t>(base);
  const double per_step = 1 / step;
  std::vector<std::uint16_t> all(kCount + 1, kVoidCode);
  all.back() = 0;
  for (std::uint32_t y = 0; y < ny; ++y)
    for (std::uint32_t x = 0; x < nx; ++x) {
      const float z = posts[y * pitch + x];
      if (!std::isnan(z))
        all[y * std::size_t{kTilePosts} + x] =
            static_cast<std::uint16_t>(double(z) * per_step - base);
    }
  const auto raw = std::as_bytes(std::span(all));
  bytes.assign(raw.begin(), raw.end());
}

// Greatest heights of blocks as parts of the tile's range, rounded up.
void append_mips(const Gathered& tile, std::vector<std::byte>& bytes) {
  std::array<std::uint16_t, kMipBlocks * kMipBlocks> codes{};
  const double low = tile.low, unit = (double(tile.high) - low) / 65535;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    if (!(tile.mips[i] > low) || unit == 0) continue;
    double code = std::min(65535.0, std::ceil((tile.mips[i] - low) / unit));
    if (low + code * unit < tile.mips[i]) code = std::min(65535.0, code + 1);
    codes[i] = static_cast<std::uint16_t>(code);
  }
  const auto raw = std::as_bytes(std::span(codes));
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

}  // namespace

TileLevels::TileLevels(const ChartRecord& chart, std::vector<TileRecord>& records)
    : chart_(chart), records_(records), map_(map_of(chart)), levels_(chart.levels) {
  for (std::uint32_t k = 0; k < chart.levels; ++k) {
    Level& level = levels_[k];
    level.across = level_side(chart.width, k);
    level.down = level_side(chart.height, k);
    level.rows.resize(std::size_t{std::min(kTilePosts, level.down.posts)} * level.across.posts);
    level.tiles.resize(level.across.tiles);
  }
}

bool TileLevels::push(std::span<const float> row, std::span<const VoidKind> voids, const Job& job,
                      const TileReceiver& to) {
  const std::uint32_t y = next_++;
  const bool last = next_ == chart_.height;
  for (std::size_t x = 0; x < voids.size(); ++x) {
    if (!std::isnan(row[x])) continue;
    const std::uint32_t bit =
        1u << unsigned(voids[x] == VoidKind::none ? VoidKind::not_finite : voids[x]);
    auto& tiles = levels_.front().tiles;
    tiles[std::min(x / kTileCells, tiles.size() - 1)].void_kinds |= bit;
    if (x % kTileCells == 0 && x > 0) tiles[x / kTileCells - 1].void_kinds |= bit;
  }
  for (std::uint32_t k = 0; k < levels_.size(); ++k) {
    Level& level = levels_[k];
    if (y % (1u << k) != 0 && !last) break;
    float* out = level.rows.data() + std::size_t{level.held} * level.across.posts;
    for (std::uint32_t p = 0; p < level.across.posts; ++p)
      out[p] = row[std::min<std::size_t>(std::size_t{p} << k, row.size() - 1)];
    ++level.held;
    if ((level.held == kTilePosts || last) && !flush(k, job, to)) return false;
  }
  return true;
}

bool TileLevels::flush(std::uint32_t k, const Job& job, const TileReceiver& to) {
  Level& level = levels_[k];
  std::vector<Made> made(level.across.tiles);
  parallel_for(
      made.size(), [&](std::size_t c) { make(k, static_cast<std::uint32_t>(c), made[c]); }, job);
  for (std::uint32_t c = 0; c < made.size(); ++c) {
    if (!to(made[c].record, made[c].bytes)) return false;
    records_.push_back(made[c].record);
    fold(k, c, made[c]);
  }
  std::ranges::fill(level.tiles, Gathered());
  const std::size_t n = level.across.posts;
  std::copy_n(level.rows.data() + (level.held - 1) * n, n, level.rows.data());
  level.held = 1;
  ++level.tile_row;
  return true;
}

void TileLevels::make(std::uint32_t k, std::uint32_t column, Made& made) {
  Level& level = levels_[k];
  Gathered& tile = level.tiles[column];
  Block block{};
  block.x0 = column * kTileCells;
  block.y0 = level.tile_row * kTileCells;
  block.pitch = level.across.posts;
  block.posts = level.rows.data() + block.x0;
  block.nx = std::min(kTilePosts, level.across.posts - block.x0);
  block.ny = level.held;
  for (std::uint32_t y = 0; y < block.ny; ++y)
    for (std::uint32_t x = 0; x < block.nx; ++x) block.voids += std::isnan(block.at(x, y));
  if (k == 0) survey(block, column, tile);
  if (k == 0 && levels_.size() > kSlopeLevel) survey_slopes(block, column, tile);

  TileRecord& record = made.record;
  record.level = k;
  record.column = column;
  record.row = level.tile_row;
  record.voids = block.voids;
  record.void_kinds = tile.void_kinds;
  if (tile.low <= tile.high) {
    record.low = tile.low;
    record.high = tile.high;
    record.error = k == 0 ? 0 : tile.error + sag(k, column, level.tile_row, tile.high);
    for (int i = 0; i < 5 && tile.cells > 0; ++i)
      record.slope[i] = static_cast<float>(tile.slope[i] / tile.cells);
  }
  if (k % kReach == 0)
    for (std::uint32_t d = 1; d <= kReach && k + d < levels_.size(); ++d)
      made.errors[d] = error_above(block, k, d);
  // note: of a coarse tile all posts may be void where finer ones are not
  if (block.voids == block.nx * block.ny) return;
  encode(block.posts, block.pitch, block.nx, block.ny, chart_.step, record, made.bytes);
  append_mips(tile, made.bytes);
  if (k < kSlopeLevel) return;
  tile.blocks.resize(std::size_t{kSlopeBlocks} * kSlopeBlocks);
  append_slopes(tile.blocks, made.bytes);
}

// Extremes, greatest heights of blocks, and slopes of a tile of level 0.
void TileLevels::survey(const Block& block, std::uint32_t column, Gathered& tile) const {
  const std::uint32_t cells_x = block.nx - 1, cells_y = block.ny - 1;
  for (std::uint32_t by = 0; by < kMipBlocks && (by == 0 || by * 8 < cells_y); ++by)
    for (std::uint32_t bx = 0; bx < kMipBlocks && (bx == 0 || bx * 8 < cells_x); ++bx) {
      const std::uint32_t x1 = std::min(bx * 8 + 8, cells_x), y1 = std::min(by * 8 + 8, cells_y);
      float low = kInfinite, high = -kInfinite;
      for (std::uint32_t y = by * 8; y <= y1; ++y)
        for (std::uint32_t x = bx * 8; x <= x1; ++x) {
          const float z = block.at(x, y);
          low = z < low ? z : low;
          high = z > high ? z : high;
        }
      tile.low = std::min(tile.low, low);
      tile.high = std::max(tile.high, high);
      tile.mips[by * kMipBlocks + bx] = high;
      const Vec2 size =
          map_.spacing(column * double(kTileCells) + bx * 8 + 4.5, block.y0 + by * 8 + 4.5);
      const double rx = 0.5 / size.x, ry = 0.5 / size.y;
      for (std::uint32_t y = by * 8; y < y1; ++y)
        for (std::uint32_t x = bx * 8; x < x1; ++x) {
          const double a = block.at(x, y), b = block.at(x + 1, y), c = block.at(x, y + 1),
                       d = block.at(x + 1, y + 1);
          const double p = ((b + d) - (a + c)) * rx, q = ((c + d) - (a + b)) * ry;
          if (!std::isfinite(p + q)) continue;
          tile.slope[0] += p;
          tile.slope[1] += q;
          tile.slope[2] += p * p;
          tile.slope[3] += q * q;
          tile.slope[4] += p * q;
          ++tile.cells;
        }
    }
}

void TileLevels::survey_slopes(const Block& block, std::uint32_t column, Gathered& tile) const {
  if (block.voids == block.nx * block.ny) return;
  const std::size_t side = slope_blocks(0);
  tile.blocks.resize(side * side);
  std::vector<Vec2> per_post;
  for (std::uint32_t y = 0; y + 1 < block.ny; y += kBlockPosts)
    for (std::uint32_t x = 0; x + 1 < block.nx; x += kBlockPosts) {
      const double middle = 0.5 * kBlockPosts + 0.5;
      const Vec2 size =
          map_.spacing(column * double(kTileCells) + x + middle, block.y0 + y + middle);
      per_post.emplace_back(1 / size.x, 1 / size.y);
    }
  add_slopes(block.posts, block.pitch, block.nx, block.ny, per_post, tile.blocks.data(), side);
}

// The largest distance of the block's posts from the triangles of the level `distance` above.
float TileLevels::error_above(const Block& block, std::uint32_t k, std::uint32_t distance) const {
  const std::uint32_t unit = 1u << distance;
  // places of posts, of level 0: the last of a level may be nearer than the others
  const auto place = [&](std::uint32_t i, std::uint32_t all) {
    return float(std::min(std::uint64_t{i} << k, std::uint64_t{all - 1}));
  };
  float u[kTilePosts];
  float most = 0, low = kInfinite, high = -kInfinite;
  for (std::uint32_t ya = 0; ya + 1 < block.ny; ya += unit) {
    const std::uint32_t yb = std::min(ya + unit, block.ny - 1);
    const float top = place(block.y0 + ya, chart_.height);
    const float tall = place(block.y0 + yb, chart_.height) - top;
    for (std::uint32_t xa = 0; xa + 1 < block.nx; xa += unit) {
      const std::uint32_t xb = std::min(xa + unit, block.nx - 1);
      const std::uint32_t n = xb - xa + 1;
      const float left = place(block.x0 + xa, chart_.width);
      const float wide = place(block.x0 + xb, chart_.width) - left;
      for (std::uint32_t i = 0; i < n; ++i)
        u[i] = (place(block.x0 + xa + i, chart_.width) - left) / wide;
      const Cell cell{block.at(xa, ya), block.at(xb, ya), block.at(xa, yb), block.at(xb, yb)};
      low = std::min({low, cell.z00, cell.z11});
      high = std::max({high, cell.z00, cell.z11});
      for (std::uint32_t y = ya; y <= yb; ++y) {
        const float v = (place(block.y0 + y, chart_.height) - top) / tall;
        std::size_t split = 0;
        while (split < n && u[split] < v) ++split;
        const float e =
            cell.row(block.posts + y * block.pitch + xa, u, n, split, v, block.voids > 0);
        most = e > most ? e : most;
      }
    }
  }
  // of the rounding of these floats
  constexpr float kRounding = 4e-7f;
  return high > low ? most + kRounding * ((high - low) + most) : most;
}

// The rise of the sphere over chords of a level's cells.
float TileLevels::sag(std::uint32_t k, std::uint32_t column, std::uint32_t row, float high) const {
  if (map_.kind == Map::Kind::none) return 0;
  double diagonal = 0;
  const double side = std::ldexp(double(kTileCells), int(k));
  for (const double x : {0.0, 0.5, 1.0})
    for (const double y : {0.0, 0.5, 1.0}) {
      const double at_x = std::min((column + x) * side, double(chart_.width - 1)) + 0.5;
      const double at_y = std::min((row + y) * side, double(chart_.height - 1)) + 0.5;
      const Vec2 size = map_.spacing(at_x, at_y);
      diagonal = std::max(diagonal, std::sqrt(size.x * size.x + size.y * size.y));
    }
  const double half = std::min(
      kPi / 2, std::ldexp(diagonal, int(k)) / std::min(map_.radius, map_.polar_radius) / 2);
  return static_cast<float>((map_.radius + high) * (1 - det::cos(half)));
}

void TileLevels::fold(std::uint32_t k, std::uint32_t column, const Made& made) {
  const Gathered& tile = levels_[k].tiles[column];
  for (std::uint32_t d = 1; d <= kReach && k + d < levels_.size(); ++d) {
    float& error = levels_[k + d].tiles[column >> d].error;
    if (k % kReach == 0) error = std::max(error, tile.error + made.errors[d]);
  }
  if (k + 1 == levels_.size()) return;
  Gathered& parent = levels_[k + 1].tiles[column >> 1];
  parent.low = std::min(parent.low, tile.low);
  parent.high = std::max(parent.high, tile.high);
  parent.error = std::max(parent.error, tile.error);
  for (int i = 0; i < 5; ++i) parent.slope[i] += tile.slope[i];
  parent.cells += tile.cells;
  parent.void_kinds |= tile.void_kinds;
  const std::uint32_t half = kMipBlocks / 2;
  const std::uint32_t x0 = (column & 1) * half, y0 = (levels_[k].tile_row & 1) * half;
  for (std::uint32_t y = 0; y < kMipBlocks; ++y)
    for (std::uint32_t x = 0; x < kMipBlocks; ++x) {
      float& out = parent.mips[(y0 + y / 2) * kMipBlocks + x0 + x / 2];
      out = std::max(out, tile.mips[y * kMipBlocks + x]);
    }
  fold_slopes(k, column, parent);
}

// Blocks of a tile into a quarter of those of its parent, whose own are as large or twice as wide.
void TileLevels::fold_slopes(std::uint32_t k, std::uint32_t column, Gathered& parent) const {
  const std::vector<SlopeSums>& blocks = levels_[k].tiles[column].blocks;
  if (blocks.empty()) return;
  const std::size_t side = slope_blocks(k), wide = slope_blocks(k + 1);
  const std::size_t shrink = 2 * side / wide;
  parent.blocks.resize(wide * wide);
  const std::size_t x0 = (column & 1) * wide / 2, y0 = (levels_[k].tile_row & 1) * wide / 2;
  for (std::size_t y = 0; y < side; ++y)
    for (std::size_t x = 0; x < side; ++x)
      parent.blocks[(y0 + y / shrink) * wide + x0 + x / shrink].add(blocks[y * side + x]);
}

}  // namespace panwright::terrain::internal
