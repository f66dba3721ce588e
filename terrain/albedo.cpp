#include "terrain/albedo.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/hash.h"
#include "terrain/internal/stored_map.h"

namespace panwright::terrain {

namespace {

constexpr std::uint32_t kMostMaps = 1024;
constexpr std::uint8_t kUnknown = 0, kGood = 1, kDamaged = 2, kReported = 3;

std::optional<std::string> albedo_problem(const AlbedoRecord& map) {
  const double numbers[] = {map.radius,
                            map.polar_radius,
                            map.center_longitude,
                            map.standard_latitude,
                            map.left,
                            map.top,
                            map.dx,
                            map.dy,
                            map.unit,
                            map.mean};
  if (!std::ranges::all_of(numbers, [](double v) { return std::isfinite(v); }) || !(map.dx > 0) ||
      !(map.dy > 0) || !(map.unit >= 0))
    return "a number of it is not finite or out of range";
  if (map.kind > std::uint32_t(Map::Kind::polar)) return "its projection is unknown";
  if (map.kind != std::uint32_t(Map::Kind::none) && (!(map.radius > 0) || !(map.polar_radius > 0)))
    return "it has no radius";
  if (map.domain != 180 && map.domain != 360) return "its longitudes have no domain";
  if (map.channels != 1 && map.channels != 3)
    return fmt::format("it has {} channels", map.channels);
  if (map.width == 0 || map.height == 0 || map.width > 1u << 30 || map.height > 1u << 30 ||
      map.levels != albedo_levels(map.width, map.height))
    return fmt::format("it has {} levels of {} x {} pixels", map.levels, map.width, map.height);
  return {};
}

}  // namespace

AlbedoSide albedo_side(std::uint32_t pixels, std::uint32_t level) {
  const std::uint64_t unit = std::uint64_t{1} << level;
  const auto here = static_cast<std::uint32_t>((pixels + unit - 1) / unit);
  return {here, (here + kAlbedoPixels - 1) / kAlbedoPixels, std::min(here, kAlbedoPixels)};
}

std::uint32_t albedo_levels(std::uint32_t width, std::uint32_t height) {
  std::uint32_t level = 0;
  while (albedo_side(std::max(width, height), level).pixels > 1) ++level;
  return level + 1;
}

std::uint64_t albedo_bytes(const AlbedoRecord& map, std::uint32_t level) {
  return std::uint64_t{2} * map.channels * albedo_side(map.width, level).stride *
         albedo_side(map.height, level).stride;
}

std::uint64_t albedo_tiles(const AlbedoRecord& map) {
  std::uint64_t sum = 0;
  for (std::uint32_t level = 0; level < map.levels; ++level)
    sum +=
        std::uint64_t{albedo_side(map.width, level).tiles} * albedo_side(map.height, level).tiles;
  return sum;
}

Map map_of(const AlbedoRecord& albedo) {
  Map map = internal::stored_map(albedo);
  map.north = albedo.flags & kAlbedoNorth;
  map.left = albedo.left;
  map.top = albedo.top;
  return map;
}

std::optional<std::string> AlbedoMaps::open(std::span<const std::byte> section,
                                            std::span<const std::byte> lists, AlbedoMaps& out) {
  AlbedoHead head;
  if (lists.size() < sizeof head) return "it has no list of albedo maps";
  std::memcpy(&head, lists.data(), sizeof head);
  if (head.map_count == 0 || head.map_count > kMostMaps ||
      lists.size() != sizeof head + head.map_count * sizeof(AlbedoRecord) +
                          std::uint64_t{head.tile_count} * sizeof(AlbedoTile))
    return "the lengths of its lists of albedo maps contradict one another";
  const std::byte* const at = lists.data() + sizeof head;
  out.section_ = section;
  out.maps_ = {reinterpret_cast<const AlbedoRecord*>(at), head.map_count};
  out.tiles_ = {reinterpret_cast<const AlbedoTile*>(at + head.map_count * sizeof(AlbedoRecord)),
                head.tile_count};
  for (std::uint32_t m = 0; m < head.map_count; ++m) {
    const AlbedoRecord& map = out.maps_[m];
    auto problem = albedo_problem(map);
    if (!problem && (map.first_tile != out.lengths_.size() ||
                     albedo_tiles(map) > head.tile_count - map.first_tile))
      problem = "its tiles are missing";
    if (problem) return fmt::format("albedo map {}: {}", m, *problem);
    for (std::uint32_t k = 0; k < map.levels; ++k)
      out.lengths_.insert(
          out.lengths_.end(),
          std::size_t{albedo_side(map.width, k).tiles} * albedo_side(map.height, k).tiles,
          static_cast<std::uint32_t>(albedo_bytes(map, k)));
  }
  if (out.lengths_.size() != head.tile_count) return "it has tiles of no albedo map";
  for (std::uint32_t t = 0; t < head.tile_count; ++t) {
    const AlbedoTile& tile = out.tiles_[t];
    if (tile.hash == 0) out.lengths_[t] = 0;
    if (tile.offset % 64 != 0 || tile.offset > section.size() ||
        out.lengths_[t] > section.size() - tile.offset)
      return fmt::format("tile {} of the albedo maps is at {} of {}", t, tile.offset,
                         section.size());
  }
  out.state_.reset(new std::atomic<std::uint8_t>[head.tile_count]());
  return {};
}

std::span<const std::byte> AlbedoMaps::bytes(std::size_t tile) const {
  return section_.subspan(tiles_[tile].offset, lengths_[tile]);
}

bool AlbedoMaps::check(std::size_t tile) const {
  const bool good = tiles_[tile].hash == 0 || hash64(bytes(tile)) == tiles_[tile].hash;
  state_[tile].store(good ? kGood : kDamaged, std::memory_order_relaxed);
  return good;
}

// Of a tile; null: it has no values.
const std::uint16_t* AlbedoMaps::codes(std::size_t tile) const {
  if (tiles_[tile].hash == 0) return nullptr;
  const std::uint8_t state = state_[tile].load(std::memory_order_relaxed);
  if (state == kUnknown ? !check(tile) : state != kGood) return nullptr;
  return reinterpret_cast<const std::uint16_t*>(section_.data() + tiles_[tile].offset);
}

// Adds the pixels about a point of a level, by its distance from their centres.
//
//   pixel  of level 0
void AlbedoMaps::add(const AlbedoRecord& map, std::uint32_t level, const Vec2& pixel, double weight,
                     Sum& to) const {
  std::size_t first = map.first_tile;
  for (std::uint32_t k = 0; k < level; ++k)
    first += std::size_t{albedo_side(map.width, k).tiles} * albedo_side(map.height, k).tiles;
  const AlbedoSide across = albedo_side(map.width, level), down = albedo_side(map.height, level);
  const double x = std::ldexp(pixel.x, -static_cast<int>(level)) - 0.5,
               y = std::ldexp(pixel.y, -static_cast<int>(level)) - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  for (int k = 0; k < 4; ++k) {
    const int i = k % 2, j = k / 2;
    const double share = (i == 0 ? 1 - (x - left) : x - left) * (j == 0 ? 1 - (y - top) : y - top);
    auto column = static_cast<std::int64_t>(left) + i;
    const auto row = std::clamp<std::int64_t>(static_cast<std::int64_t>(top) + j, 0,
                                              std::int64_t{down.pixels} - 1);
    if (map.flags & kAlbedoWraps)
      column = (column + across.pixels) % across.pixels;
    else
      column = std::clamp<std::int64_t>(column, 0, std::int64_t{across.pixels} - 1);
    const auto c = static_cast<std::uint32_t>(column), r = static_cast<std::uint32_t>(row);
    const std::uint16_t* const tile =
        codes(first + std::size_t{r / kAlbedoPixels} * across.tiles + c / kAlbedoPixels);
    if (tile == nullptr) continue;
    const std::uint16_t* const code =
        tile + (std::size_t{r % kAlbedoPixels} * across.stride + c % kAlbedoPixels) * map.channels;
    if (*code == kNoAlbedo) continue;
    const double unit = weight * share * map.unit;
    to.value += map.channels == 3 ? unit * Vec3(code[0], code[1], code[2]) : Vec3(unit * code[0]);
    to.weight += weight * share;
  }
}

Vec3 AlbedoMaps::at(const LatLon& place, double size) const {
  for (const AlbedoRecord& record : maps_) {
    const Map map = map_of(record);
    const Vec2 pixel = map.kind == Map::Kind::none ? Vec2((place.longitude - map.left) / map.dx,
                                                          (map.top - place.latitude) / map.dy)
                                                   : map.pixel(place, record.width);
    const bool within =
        pixel.y >= 0 && pixel.y <= record.height &&
        ((record.flags & kAlbedoWraps) != 0 || (pixel.x >= 0 && pixel.x <= record.width));
    if (!within) continue;
    constexpr double kLog2 = 0.6931471805599453;
    double level = 0;
    if (size > 0) {
      // a pixel is as wide as it is high, but for cylindrical maps far from their latitude
      const Vec2 metres = map.spacing(pixel.x, pixel.y);
      level = std::clamp(det::log(size / std::max(metres.x, metres.y)) / kLog2, 0.0,
                         double(record.levels - 1));
    }
    const auto finer = static_cast<std::uint32_t>(level);
    const double rest = level - finer;
    Sum sum;
    add(record, finer, pixel, 1 - rest, sum);
    if (rest > 0) add(record, finer + 1, pixel, rest, sum);
    if (sum.weight >= 0.5) return sum.value / sum.weight;
  }
  return Vec3(1);
}

void AlbedoMaps::report_damaged(const std::string& name, DiagnosticLog& log) const {
  std::size_t found = 0;
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    std::uint8_t state = kDamaged;
    found += state_[i].load(std::memory_order_relaxed) == kDamaged &&
             state_[i].compare_exchange_strong(state, kReported);
  }
  if (found > 0)
    log.report_file(Code("W9615"), name,
                    fmt::format("{} tiles of albedo maps do not match their hashes: they are left "
                                "out",
                                found),
                    "panwright check names all that are damaged");
}

}  // namespace panwright::terrain
