// Albedo maps of a terrain: factors of the colour of its material by place, as pyramids of means,
// mapped and read in place. Layout: docs/terrain-tiles.md.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "terrain/map.h"

namespace panwright::terrain {

// ---- layout within the section `tiles`, little-endian

inline constexpr std::uint32_t kAlbedoPixels = 256;  // on a side of a tile
inline constexpr std::uint16_t kNoAlbedo = 0xffff;   // code of a pixel without a value

struct AlbedoHead {
  std::uint32_t map_count, tile_count;
  std::uint64_t reserved[7];
};
static_assert(sizeof(AlbedoHead) == 64);

// A map. Level k has means of 2^k x 2^k pixels, those of the last column and row of what is left.
// The last level is one pixel.
struct AlbedoRecord {
  double radius;        // metres, at the equator; 0 of a plane
  double polar_radius;  // metres
  double center_longitude;
  double standard_latitude;  // degrees
  double left, top;          // metres on the map: outer corner of the first pixel
  double dx, dy;             // metres of a pixel on the map
  double unit;               // factor of a code of 1
  double mean;               // of the factors, by area and over the channels
  std::uint32_t kind;        // Map::Kind; none: a plane
  std::uint32_t flags;       // kAlbedoNorth, kAlbedoWraps
  std::uint32_t width, height;
  std::uint32_t channels;  // 1 or 3
  std::uint32_t levels;
  std::uint32_t first_tile;
  std::uint32_t domain;  // longitudes: 180 or 360
  std::uint64_t reserved[2];
};
static_assert(sizeof(AlbedoRecord) == 128);
inline constexpr std::uint32_t kAlbedoNorth = 1, kAlbedoWraps = 2;

// u16 codes by channel, of kAlbedoPixels² pixels, or of all of a level with fewer along a side;
// pixels beyond the map have none.
struct AlbedoTile {
  std::uint64_t offset;  // bytes from the beginning of the section, a multiple of 64
  std::uint64_t hash;    // XXH3-64 of its bytes; 0 and no bytes: no pixel has a value
};
static_assert(sizeof(AlbedoTile) == 16);

// Along a side of level k: pixels, tiles, and pixels of a tile.
struct AlbedoSide {
  std::uint32_t pixels, tiles, stride;
};
AlbedoSide albedo_side(std::uint32_t pixels, std::uint32_t level);
std::uint32_t albedo_levels(std::uint32_t width, std::uint32_t height);
std::uint64_t albedo_tiles(const AlbedoRecord& map);                       // of all levels
std::uint64_t albedo_bytes(const AlbedoRecord& map, std::uint32_t level);  // of a tile
Map map_of(const AlbedoRecord& albedo);

// ---- reading

// Albedo maps of a section. Thread-safe. Damaged tiles have no values.
class AlbedoMaps {
 public:
  // Returns what is wrong with the lists of a section, if anything.
  //
  //   section  bytes of tiles; they outlive this
  //   lists    of the head, maps and tiles
  static std::optional<std::string> open(std::span<const std::byte> section,
                                         std::span<const std::byte> lists, AlbedoMaps& out);

  bool empty() const { return maps_.empty(); }
  std::span<const AlbedoRecord> maps() const { return maps_; }
  std::span<const AlbedoTile> tiles() const { return tiles_; }

  // Returns the factors of the material's colour at a place: of the first map with a value there;
  // 1 without. Pixels are interpolated, then levels.
  //
  //   place  of planes: longitude and latitude are x and y in metres
  //   size   metres of the ground that they are the mean of; 0: the finest pixels
  Vec3 at(const LatLon& place, double size) const;

  // As those of Tiles.
  void report_damaged(const std::string& name, DiagnosticLog& log) const;
  // Hashes a tile anew.
  bool check(std::size_t tile) const;
  std::span<const std::byte> bytes(std::size_t tile) const;

 private:
  struct Sum {
    Vec3 value{0};
    double weight = 0;
  };
  void add(const AlbedoRecord& map, std::uint32_t level, const Vec2& pixel, double weight,
           Sum& to) const;
  const std::uint16_t* codes(std::size_t tile) const;

  std::span<const std::byte> section_;
  std::span<const AlbedoRecord> maps_;
  std::span<const AlbedoTile> tiles_;
  std::vector<std::uint32_t> lengths_;  // of tiles, bytes
  std::shared_ptr<std::atomic<std::uint8_t>[]> state_;
};

}  // namespace panwright::terrain
