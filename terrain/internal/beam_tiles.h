// Tiles that rays of a beam may meet. Private to terrain.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "terrain/ground.h"

namespace panwright::terrain::internal {

struct BeamState {
  struct Tile {
    double entry;  // metres: no ray meets it before
    std::uint32_t tile;
    std::uint32_t first = 0, end = 0;  // of squares, that rays may meet; none: any
  };

  Vec3 origin{0}, axis{0};
  double square = 0;  // of the radius
  double cosine = 1;
  bool leaves_ground = false;
  const GroundLevels* levels = nullptr;
  std::shared_ptr<const void> use;    // of the trees
  std::vector<Tile> tiles;            // by chart, then from the nearest
  std::vector<std::size_t> ends;      // by chart, in tiles
  std::vector<std::uint8_t> squares;  // of tiles, in Morton order

  bool holds(const Vec3& from, const Vec3& direction) const {
    const Vec3 off = from - origin;
    return glm::dot(off, off) <= square && glm::dot(direction, axis) >= cosine;
  }
  std::span<const std::uint8_t> squares_of(const Tile& tile) const {
    return std::span(squares).subspan(tile.first, tile.end - tile.first);
  }
  std::span<const Tile> of_chart(std::uint32_t chart) const {
    const std::size_t begin = chart > 0 ? ends[chart - 1] : 0;
    return std::span(tiles).subspan(begin, ends[chart] - begin);
  }
};

}  // namespace panwright::terrain::internal
