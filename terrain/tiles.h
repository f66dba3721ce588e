// Terrain tiles of a pan file: charts of a body, each a quadtree of tiles of posts, mapped and read
// in place. Layout: docs/terrain-tiles.md.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/math.h"
#include "base/result.h"
#include "pan/model.h"
#include "terrain/albedo.h"
#include "terrain/map.h"

namespace panwright::terrain {

// ---- layout of the section `tiles`, little-endian

inline constexpr std::uint32_t kTilesSection = 31;  // kind of the section in the pan file
inline constexpr std::uint32_t kTileCells = 256;    // on a side of a tile
inline constexpr std::uint32_t kTilePosts = 257;
inline constexpr std::uint32_t kMipBlocks = 32;    // on a side of a tile, of 8 cells
inline constexpr std::uint32_t kTilesVersion = 3;  // 1: without blocks of slopes; 2: and albedo
inline constexpr std::uint16_t kVoidCode = 0xffff;
inline constexpr std::uint32_t kSlopeLevel = 3;     // the first whose tiles have slopes
inline constexpr std::uint32_t kSlopeBlocks = 128;  // on a side of a tile, of 2 cells
inline constexpr std::int16_t kNoSlope = -32768;

enum class TileForm : std::uint32_t {
  nothing,  // no post has a height; no bytes
  codes,    // height = step · (base + code), code u16; 0xffff: void
  floats,   // heights in metres, f32; NaN: void
};

struct ChartRecord {
  char body[32];            // as the elevation file names it, filled with zeros
  char frame[64];           // coordinate system
  double radius;            // metres, at the equator; 0 of a plane
  double polar_radius;      // metres
  double center_longitude;  // degrees east
  double standard_latitude;
  double left, top;      // metres on the map of post (0, 0)
  double dx, dy;         // metres on the map between posts
  double step;           // metres of a code; 0: all tiles are floats
  double error;          // metres: no stored height lies further from its source
  double low, high;      // metres, of all posts
  std::uint32_t kind;    // Map::Kind; none: a plane
  std::uint32_t flags;   // kChartNorth, kChartWraps
  std::uint32_t width;   // posts, the closing column of a map round the body included
  std::uint32_t height;  //
  std::uint32_t levels;  //
  std::uint32_t first_tile;
  std::uint32_t tile_count;
  std::uint32_t domain;  // longitudes: 180 or 360
  std::uint64_t reserved[4];
};
static_assert(sizeof(ChartRecord) == 256);
inline constexpr std::uint32_t kChartNorth = 1, kChartWraps = 2;

struct TileRecord {
  std::uint64_t offset;  // bytes from the beginning of the section, a multiple of 64
  std::uint64_t hash;    // XXH3-64 of its bytes
  std::uint32_t length;  // bytes: posts, then mips
  std::uint32_t level;   // 0: every post; each next every second one
  std::uint32_t column, row;
  std::uint32_t form;        // TileForm
  std::int32_t base;         // of codes
  std::uint32_t voids;       // posts of the tile without a height
  std::uint32_t void_kinds;  // bit k: a post of VoidKind k; levels from 1 on: of those below
  float low, high;           // metres: no post of level 0 in the tile's area lies outside
  float error;               // metres: no post of level 0 lies further from the tile's triangles;
                             // infinite: voids are elsewhere. Never below those of the level below
  float slope[5];            // means over cells of level 0: p, q, p², q², pq; p east, q south
  std::uint32_t reserved[4];
};
static_assert(sizeof(TileRecord) == 96);

// Moments of the slopes of level 0 over 2 x 2 cells of a tile, in parts of the tile's unit.
struct SlopeBlock {
  std::int16_t p, q;           // means / 32767, to the right and down the map; p kNoSlope: none
  std::uint16_t across, down;  // standard deviations / 65535
  std::int16_t together;       // correlation / 32767
};
static_assert(sizeof(SlopeBlock) == 10);

struct TilesTail {
  char magic[8];  // "PWTERRA\0"
  std::uint32_t version, chart_count;
  std::uint64_t tile_count;
  std::uint64_t charts_offset, tiles_offset;  // from the beginning of the section
  std::uint64_t hash;  // XXH3-64 of charts, tiles, albedo maps and the 40 bytes above
  std::uint64_t reserved[2];
};
static_assert(sizeof(TilesTail) == 64);

// Map of a chart, in which post (i, j) is at column i + 0.5, row j + 0.5.
Map map_of(const ChartRecord& chart);

// Posts and tiles of a level, along one side of `posts` posts of level 0. The last post of each
// level is the last of level 0.
struct LevelSide {
  std::uint32_t posts, tiles;
};
LevelSide level_side(std::uint32_t posts, std::uint32_t level);
// Levels until one tile holds all.
std::uint32_t level_count(std::uint32_t width, std::uint32_t height);

// ---- reading

// Posts of one tile.
struct TileView {
  const TileRecord* record = nullptr;
  std::span<const std::uint16_t> codes;  // kTilePosts², or empty
  std::span<const float> floats;         // kTilePosts², or empty
  std::span<const std::uint16_t> mips;   // kMipBlocks²: greatest height of 8 x 8 cells
  std::span<const SlopeBlock> slopes;    // kSlopeBlocks², from kSlopeLevel on, or empty
  double slope_unit = 0;
  double step = 0;

  // Metres over the sphere; NaN where void. Expects: column, row < kTilePosts.
  double height(std::uint32_t column, std::uint32_t row) const;
  // Metres: no post of level 0 in a block lies higher.
  double mip(std::uint32_t column, std::uint32_t row) const {
    return record->low +
           mips[row * kMipBlocks + column] * ((double(record->high) - double(record->low)) / 65535);
  }
};

class Tiles {
 public:
  // Maps a pan file and checks the records of charts and tiles; posts are not touched.
  //
  // Fails: as pan::Model::open; E9610. Cost: O(tiles): with the ground at places, 10 ms of 14,000.
  static Result<Tiles> open(const std::filesystem::path& path, DiagnosticLog& log);
  // The same of an opened model; nothing, without a report, where it has no terrain.
  static Result<std::optional<Tiles>> of(std::shared_ptr<const pan::Model> model,
                                         DiagnosticLog& log);

  const std::string& name() const { return model_->name(); }
  const pan::Model& model() const { return *model_; }
  std::span<const ChartRecord> charts() const { return charts_; }
  std::span<const TileRecord> records() const { return records_; }
  // Expects: a tile of the chart.
  std::uint32_t index(std::uint32_t chart, std::uint32_t level, std::uint32_t column,
                      std::uint32_t row) const;
  std::uint32_t chart_of(std::uint32_t tile) const;
  // Looks at the tile's bytes, which are hashed at the first call; nothing where it is damaged or
  // void. Thread-safe.
  std::optional<TileView> view(std::uint32_t tile) const;
  // Returns whether view() found a tile damaged.
  bool is_damaged(std::uint32_t tile) const { return state_[tile].load() >= kDamaged; }
  // Reports the tiles that view() has found damaged since the last call: W9615, for many the first
  // ones and their number. Cost: O(tiles), 10 µs of 14,000.
  void report_damaged(DiagnosticLog& log) const;
  // Hashes all tiles, looks at the padding between them, and reports what is damaged. True where
  // nothing is.
  //
  // Fails: E9611; E0001. Cost: one pass over the tiles.
  bool check(DiagnosticLog& log, const Job& job = {}) const;

  Map map(std::uint32_t chart) const { return map_of(charts_[chart]); }
  const AlbedoMaps& albedo() const { return albedo_; }

 private:
  Tiles() = default;
  std::uint32_t version_ = kTilesVersion;
  static constexpr std::uint8_t kUnknown = 0, kGood = 1, kDamaged = 2, kReported = 3;
  bool check_padding(DiagnosticLog& log) const;
  bool check_albedo(DiagnosticLog& log, const Job& job) const;
  std::shared_ptr<const pan::Model> model_;
  std::span<const std::byte> bytes_;  // of the section
  std::span<const ChartRecord> charts_;
  std::span<const TileRecord> records_;
  std::shared_ptr<std::atomic<std::uint8_t>[]> state_;
  AlbedoMaps albedo_;
};

// Text of a field filled with zeros.
std::string_view field_text(std::span<const char> field);
// "tile of level 2, column 3, row 1 of chart 0"
std::string tile_words(const Tiles& tiles, std::uint32_t tile);

}  // namespace panwright::terrain
