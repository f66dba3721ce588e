// Triangles of level 0 of one chart in space, and rays against them. Private to terrain.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "terrain/ground.h"

namespace panwright::terrain::internal {

struct TerrainRay {
  Vec3 origin, direction;  // metres; unit
  double least, most;      // distances
};

struct TriangleHit {
  double distance = 0;
  std::uint32_t column = 0, row = 0, triangle = 0;
  std::array<Vec3, 3> corners{};
};

// Returns false for a hit that does not count.
using AcceptHit = std::function<bool(const TriangleHit&)>;

class ChartSurface {
 public:
  ChartSurface(const Tiles& tiles, std::uint32_t chart);

  GroundPoint at(const LatLon& place) const;
  // Place of a body-fixed point; of a plane x and y.
  LatLon place_of(const Vec3& position) const;
  // Nearest accepted hit, or any.
  std::optional<TriangleHit> cast(const TerrainRay& ray, bool any, const AcceptHit& accept) const;
  GroundPoint point_of(const TriangleHit& hit, const Vec3& position) const;

 private:
  // A square of cells: bounding sphere about its middle, and range of heights.
  struct Node {
    std::uint32_t tile = 0;        // of level 0 within cells of one tile
    std::uint32_t x = 0, y = 0;    // first cell of level 0
    std::uint32_t nx = 0, ny = 0;  // cells
    double low = 0, high = 0;      // metres
    double entry = 0;              // distance at which the ray comes in
  };
  struct Walk;

  bool is_plane() const { return map_.kind == Map::Kind::none; }
  Vec3 vertical(double column, double row) const;  // unit; post coordinates
  double radius(const Vec3& vertical) const;       // of the ellipsoid, metres
  Vec3 point(double column, double row, double height) const;
  double cell_reach(std::uint32_t y0, std::uint32_t y1) const;
  bool meets(const TerrainRay& ray, double most, Node& node) const;
  void visit_tile(Walk& walk, std::uint32_t level, std::uint32_t column, std::uint32_t row) const;
  void visit_block(Walk& walk, const TileView& view, const Node& node) const;
  void visit_cells(Walk& walk, const TileView& view, const Node& node) const;
  std::optional<TriangleHit> triangle_on(const TileView& view, std::uint32_t column,
                                         std::uint32_t row, std::uint32_t which,
                                         const TerrainRay& ray) const;
  std::optional<TileView> tile_of(std::uint32_t column, std::uint32_t row) const;

  const Tiles* tiles_;
  std::uint32_t chart_;
  const ChartRecord* record_;
  Map map_;
  std::vector<std::uint32_t> first_;  // tile of each level
  std::vector<Vec2> columns_, rows_;  // of a cylindrical map: sine and cosine at posts
  double largest_radius_ = 0, least_radius_ = 0;
};

}  // namespace panwright::terrain::internal
