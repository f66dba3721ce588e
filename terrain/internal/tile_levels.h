// Rows of heights into the tiles of all levels, as they come. Private to terrain.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "base/job.h"
#include "terrain/dem.h"
#include "terrain/internal/slope_blocks.h"
#include "terrain/tiles.h"

namespace panwright::terrain::internal {

// Findings of the tiles below a tile.
struct Gathered {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();
  float error = 0;  // metres, without the sag of chords on the sphere
  double slope[5] = {};
  double cells = 0;  // number of cells in the sums of slopes
  std::uint32_t void_kinds = 0;
  std::array<float, kMipBlocks * kMipBlocks> mips;
  std::vector<SlopeSums> blocks;  // slope_blocks(level)², or empty
  Gathered() { mips.fill(-std::numeric_limits<float>::infinity()); }
};

// A record without its place, and the bytes of its tile.
using TileReceiver = std::function<bool(TileRecord&, std::span<const std::byte>)>;

class TileLevels {
 public:
  // records: gets those of all tiles, in the order in which they are complete
  TileLevels(const ChartRecord& chart, std::vector<TileRecord>& records);

  // Takes the next row, from the top; NaN where void. False where `to` returns it.
  bool push(std::span<const float> row, std::span<const VoidKind> voids, const Job& job,
            const TileReceiver& to);

 private:
  // Levels whose errors are taken from the posts of one level.
  static constexpr std::uint32_t kReach = 8;

  struct Level {
    LevelSide across, down;
    std::vector<float> rows;      // kTilePosts · across.posts
    std::uint32_t held = 0;       // rows
    std::uint32_t tile_row = 0;   // being filled
    std::vector<Gathered> tiles;  // across.tiles
  };
  struct Made {
    TileRecord record{};
    std::vector<std::byte> bytes;
    std::array<float, kReach + 1> errors{};  // of the levels above, by their distance
  };
  struct Block;

  bool flush(std::uint32_t level, const Job& job, const TileReceiver& to);
  void make(std::uint32_t level, std::uint32_t column, Made& made);
  void survey(const Block& block, std::uint32_t column, Gathered& tile) const;
  void survey_slopes(const Block& block, std::uint32_t column, Gathered& tile) const;
  float error_above(const Block& block, std::uint32_t level, std::uint32_t distance) const;
  float sag(std::uint32_t level, std::uint32_t column, std::uint32_t row, float high) const;
  void fold(std::uint32_t level, std::uint32_t column, const Made& made);
  void fold_slopes(std::uint32_t level, std::uint32_t column, Gathered& parent) const;

  const ChartRecord& chart_;
  std::vector<TileRecord>& records_;
  Map map_;
  std::vector<Level> levels_;
  std::uint32_t next_ = 0;  // row
};

}  // namespace panwright::terrain::internal
