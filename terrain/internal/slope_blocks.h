// Moments of the slopes of level 0 over blocks of posts: of the smooth ground that images shade.
// Private to terrain.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"
#include "terrain/tiles.h"

namespace panwright::terrain::internal {

// Sums over cells of level 0, of p and q along the map's rows and columns.
struct SlopeSums {
  float cells = 0, p = 0, q = 0, pp = 0, qq = 0, pq = 0;

  void add(const SlopeSums& other) {
    cells += other.cells;
    p += other.p;
    q += other.q;
    pp += other.pp;
    qq += other.qq;
    pq += other.pq;
  }
};

// Posts of level 0 on a side of the finest blocks that are kept.
inline constexpr std::uint32_t kBlockPosts = 16;
// Blocks on a side of a tile of a level, from kSlopeLevel on kSlopeBlocks.
constexpr std::uint32_t slope_blocks(std::uint32_t level) {
  return level >= kSlopeLevel ? kSlopeBlocks : kTileCells / kBlockPosts << level;
}

// Sums over blocks of kBlockPosts² cells of a rectangle of posts, NaN where void; slopes of posts
// are those of the posts beside them within the rectangle, and within a cell between its corners'.
//
//   posts  ny rows of nx, `pitch` apart
//   per_post  by block, from the left, then down: 1 / metres between posts
//   out    ceil((nx - 1) / 16) · ceil((ny - 1) / 16), rows `out_pitch` apart: are added to
void add_slopes(const float* posts, std::size_t pitch, std::uint32_t nx, std::uint32_t ny,
                std::span<const Vec2> per_post, SlopeSums* out, std::size_t out_pitch);

// Cells of a rectangle of posts.
struct CellRange {
  std::uint32_t left, top, columns, rows;
};
// The same of some cells of few posts, nx · ny of them, at most kTilePosts a row.
SlopeSums slopes_within(const float* posts, std::uint32_t nx, std::uint32_t ny,
                        const CellRange& cells, const Vec2& per_post);

// Bytes of kSlopeBlocks² blocks: their unit, then the blocks.
void append_slopes(std::span<const SlopeSums> blocks, std::vector<std::byte>& bytes);

// Mean and covariance of slopes.
struct SlopeMoments {
  double p = 0, q = 0, pp = 0, qq = 0, pq = 0;
};
SlopeMoments moments_of(const SlopeSums& sums);
SlopeMoments moments_of(const SlopeBlock& block, double unit);

}  // namespace panwright::terrain::internal
