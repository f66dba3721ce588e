// Triangles of one chart in space, and rays against them. Private to terrain.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "terrain/ground.h"
#include "terrain/internal/beam_tiles.h"
#include "terrain/internal/ray_grid.h"
#include "terrain/internal/slope_blocks.h"

namespace panwright::terrain::internal {

class TreeCache;

// As TileView::height(), in the loops of others.
inline double height_of(const TileView& view, std::uint32_t column, std::uint32_t row) {
  const std::size_t at = std::size_t{row} * kTilePosts + column;
  if (view.codes.empty()) return view.floats[at];
  const std::uint16_t code = view.codes[at];
  if (code == kVoidCode) return std::numeric_limits<double>::quiet_NaN();
  return view.step * (double(view.record->base) + code);
}

struct TerrainRay {
  Vec3 origin, direction;  // metres; unit
  double least, most;      // distances
};

struct TerrainBeam {
  Vec3 origin, axis;
  double radius, sine;         // metres: of origins; of the largest angle to the axis
  bool leaves_ground = false;  // as of GroundWalk
};

struct TriangleHit {
  double distance = 0;
  std::uint32_t level = 0;  // column and row are those of its cells
  std::uint32_t column = 0, row = 0, triangle = 0;
  std::array<Vec3, 3> corners{};
};

// Returns false for a hit that does not count.
using AcceptHit = std::function<bool(const TriangleHit&)>;

// State of a ray on its way through a chart.
struct GroundWalk {
  const TerrainRay& ray;
  bool any = false;                   // the first hit will do
  const AcceptHit* accept = nullptr;  // null: all count
  double most = 0;
  std::optional<TriangleHit> best;
  bool leaves_ground = false;  // it starts on the ground or above it, and any will do
};

// State of a search for the ground nearest to a point.
struct GroundApproach {
  const Vec3& point;
  const AcceptHit* accept = nullptr;  // null: all count; of hits nearest to the point
  double squared = 0;                 // m²: of the distance, to be less
  std::optional<TriangleHit> best;
  Vec3 nearest{0};  // on its triangle
};

// Cell of a level.
struct CellPosts {
  std::uint64_t surface = 0;  // its number; 0: none
  std::uint32_t level = 0, column = 0, row = 0;
  enum class Normals : std::uint8_t { unknown, none, known } state = Normals::unknown;
  std::array<Vec3, 4> posts, normals;  // row by row; unit
};

class ChartSurface {
 public:  // fine_tiles: as of Ground.
  ChartSurface(const Tiles& tiles, std::uint32_t chart, std::size_t fine_tiles);
  const ChartRecord& record() const { return *record_; }
  bool is_plane() const { return map_.kind == Map::Kind::none; }
  // Returns whether post() takes a microsecond: of polar maps of ellipsoids.
  bool is_costly() const { return map_.kind == Map::Kind::polar && !is_sphere_; }
  // Post of a level in space, at a height.
  Vec3 post(std::uint32_t level, std::uint32_t column, std::uint32_t row, double height) const {
    return post({std::min(column << level, record_->width - 1),
                 std::min(row << level, record_->height - 1)},
                height);
  }

  // Metres, at most, between the ground of a rectangle of the map and the bilinear interpolation of
  // its corners.
  //
  //   posts_across, posts_down  of level 0
  double bend(double posts_across, double posts_down, double high) const;
  // Metres: verticals bend by bend() over this, radians.
  double bend_radius() const {
    return is_plane() ? 1 : std::min(record_->radius, record_->polar_radius);
  }

  // Posts of a rectangle of a level, rows one after the other; bit-equal to post().
  //
  //   height  of the post i to the right and j down
  template <class Height>
  void posts(std::uint32_t level, std::uint32_t column, std::uint32_t row, std::uint32_t across,
             std::uint32_t down, const Height& height, Vec3* out) const {
    if (map_.kind != Map::Kind::cylindrical || !is_sphere_) {
      for (std::uint32_t j = 0; j < down; ++j)
        for (std::uint32_t i = 0; i < across; ++i)
          *out++ = post(level, column + i, row + j, height(i, j));
      return;
    }
    for (std::uint32_t j = 0; j < down; ++j) {
      const Vec2 y = rows_[std::min((row + j) << level, record_->height - 1)];
      for (std::uint32_t i = 0; i < across; ++i) {
        const Vec2 x = columns_[std::min((column + i) << level, record_->width - 1)];
        *out++ = (record_->radius + height(i, j)) * Vec3(y.y * x.y, y.y * x.x, y.x);
      }
    }
  }

  // Cell with its posts, until the next call of this thread; kept for a while.
  //
  //   height  as of posts()
  template <class Height>
  const CellPosts& cell(std::uint32_t level, std::uint32_t column, std::uint32_t row,
                        const Height& height) const {
    CellPosts& out = slot(column, row);
    if (out.surface == number_ && out.column == column && out.row == row && out.level == level)
      return out;
    posts(level, column, row, 2, 2, height, out.posts.data());
    out.level = level;
    out.column = column;
    out.row = row;
    out.state = CellPosts::Normals::unknown;
    out.surface = number_;
    return out;
  }

  GroundPoint at(const LatLon& place) const;
  // Place of a body-fixed point; of a plane x and y.
  LatLon place_of(const Vec3& position) const;
  // Sets the nearest accepted hit of a ray, or any.
  //
  //   refined  by tile of the file, 0: it is fine enough; empty: level 0
  void cast(GroundWalk& walk, std::span<const std::uint8_t> refined, TreeCache& trees) const;
  // The same among tiles of a beam, and their squares.
  void cast(GroundWalk& walk, const BeamState& beam, TreeCache& trees) const;
  // Takes the nearest triangles of rays among tiles of a beam. False: it takes fewer rays than
  // cells.
  bool cast(RayGrid& rays, const BeamState& beam, const AcceptPoint* accepts,
            TreeCache& trees) const;
  // Adds the tiles that rays of a beam may meet, from the nearest.
  void find(const TerrainBeam& beam, std::span<const std::uint8_t> refined,
            std::vector<BeamState::Tile>& out) const;
  // Sets the nearest accepted triangle of level 0.
  void approach(GroundApproach& walk, TreeCache& trees) const;
  SmoothGround smooth(const GroundPoint& point) const;
  GroundRelief relief(const GroundPoint& point) const;
  GroundPoint point_of(const TriangleHit& hit, const Vec3& position, bool slope) const;
  // Metres between an observer and the ground of a tile, at least; and between its posts, at most.
  double distance_to(std::uint32_t tile, const Vec3& observer) const;
  double spacing(std::uint32_t tile) const;

 private:
  struct PostIndex {
    std::uint32_t column, row;  // of level 0
  };
  // Box about the ground of a tile of any level, in axes of its own.
  struct TileBox {
    Vec3 centre{0};
    Mat3 axes{1};  // to them
    Vec3 half{0};
    double radius = 0;
  };

  // Of cells nearby each has its own.
  static CellPosts& slot(std::uint32_t column, std::uint32_t row);
  void set_normals(const GroundPoint& point, CellPosts& cell) const;
  Vec3 post(PostIndex index, double height) const;
  Vec3 vertical(PostIndex index) const;       // unit
  double radius(const Vec3& vertical) const;  // of the ellipsoid, metres
  TileBox box_of(std::uint32_t tile) const;
  // Returns whether a ray comes within a distance of a box, and from where on.
  bool meets(const TileBox& box, const TerrainRay& ray, double within, double& entry) const;
  std::optional<TriangleHit> triangle_on(const TileView& view, std::uint32_t column,
                                         std::uint32_t row, std::uint32_t which,
                                         const TerrainRay& ray) const;
  // Posts of a level in space, NaN where void or beyond the map; the tiles that they lie in are
  // kept.
  class LevelPosts;
  void set_posts(const GroundPoint& point, Vec3 (&grid)[4][4]) const;
  // Sums of slopes of level 0 over two by two cells of a level below kSlopeLevel.
  SlopeSums fine_slopes(const GroundPoint& point) const;
  Vec2 spacing_at(PostIndex index) const;
  // Moments of the block about a cell of a level from kSlopeLevel on.
  std::optional<SlopeMoments> stored_slopes(std::uint32_t level, std::uint32_t column,
                                            std::uint32_t row) const;
  std::optional<SlopeMoments> split_slopes(const GroundPoint& point) const;
  std::optional<TileView> tile_of(std::uint32_t column, std::uint32_t row) const;

  const Tiles* tiles_;
  std::uint32_t chart_;
  std::uint64_t number_;  // of this surface alone
  const ChartRecord* record_;
  Map map_;
  std::vector<std::uint32_t> first_;  // tile of each level
  std::vector<Vec2> columns_, rows_;  // of a cylindrical map: sine and cosine at posts
  std::vector<double> row_radii_;     // of one of an ellipsoid
  std::vector<TileBox> boxes_;        // one for each tile of the chart
  Vec2 centre_turn_{0, 1};            // of a polar map: sine and cosine of its longitude
  // of a polar map: metres, 2 R f; of a cylindrical one: 1 / cosine of the standard latitude
  double scale_ = 0;
  bool is_sphere_ = false;
  bool is_large_ = false;  // of more fine tiles
};

}  // namespace panwright::terrain::internal
