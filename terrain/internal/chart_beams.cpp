// Charts against rays of beams.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "terrain/internal/chart_surface.h"
#include "terrain/internal/tile_tree.h"
#include "terrain/internal/tree_cache.h"

namespace panwright::terrain::internal {

void ChartSurface::cast(GroundWalk& walk, const BeamState& beam, TreeCache& trees) const {
  const auto tiles = beam.of_chart(chart_);
  for (const BeamState::Tile& each : tiles) {
    double entry = 0;
    if (each.entry > walk.most) return;
    const TerrainRay& ray = walk.ray;
    // most rays that leave the ground are answered by the tile that they leave
    const bool sure = tiles.size() == 1 || (walk.leaves_ground && each.entry <= 0);
    if (!sure && !meets(boxes_[each.tile - record_->first_tile],
                        {ray.origin, ray.direction, ray.least, walk.most}, 0, entry))
      continue;
    const TileTree& tree = trees.of(each.tile, *this);
    if (each.first < each.end)
      tree.cast(walk, beam.squares_of(each));
    else
      tree.cast(walk);
    if (walk.any && walk.best) return;
  }
}

// The nearest tiles and squares first: rays that have met something ask for nothing behind it.
bool ChartSurface::cast(RayGrid& rays, const BeamState& beam, const AcceptPoint* accepts,
                        TreeCache& trees) const {
  static thread_local std::vector<TileTree::SeenSquare> squares;
  constexpr double kFew = 1.8;
  std::size_t leaves = 0;
  double farthest = rays.farthest();
  for (const BeamState::Tile& each : beam.of_chart(chart_)) {
    if (each.entry > farthest) break;
    const TileTree& tree = trees.of(each.tile, *this);
    squares.clear();
    tree.find(rays.pyramid(), squares);
    std::ranges::sort(squares, {}, [](const TileTree::SeenSquare& square) {
      return std::pair(square.ahead, square.code);
    });
    for (const TileTree::SeenSquare& square : squares) {
      if (square.ahead > farthest) break;
      if (tree.rays_of_leaf(rays, square) < kFew) return false;
      leaves += tree.cast(rays, each.tile, square.code, accepts);
      if (leaves > rays.size()) return false;
      farthest = rays.farthest();
    }
  }
  return true;
}

// A ray of the beam that meets a box at a distance t is there within radius + t sine of a place of
// the axis, which is no further than t from its origin.
void ChartSurface::find(const TerrainBeam& beam, std::span<const std::uint8_t> refined,
                        std::vector<BeamState::Tile>& out) const {
  struct Entry {
    std::uint32_t level, column, row;
  };
  const std::size_t first = out.size();
  const TerrainRay axis{beam.origin, beam.axis, 0, std::numeric_limits<double>::infinity()};
  std::array<Entry, 3 * 32 + 4> stack;
  std::size_t count = 0;
  stack[count++] = {record_->levels - 1, 0, 0};
  while (count > 0) {
    const Entry here = stack[--count];
    const std::uint32_t tile =
        first_[here.level] + here.row * level_side(record_->width, here.level).tiles + here.column;
    const TileBox& box = boxes_[tile - record_->first_tile];
    const Vec3 to = box.centre - beam.origin;
    const double farthest = std::sqrt(glm::dot(to, to)) + box.radius + beam.radius;
    double entry = 0;
    if (!meets(box, axis, beam.radius + farthest * beam.sine, entry)) continue;
    if (here.level == 0 || (!refined.empty() && refined[tile] == 0)) {
      out.push_back({entry, tile});
      continue;
    }
    const std::uint32_t level = here.level - 1;
    const std::uint32_t across = level_side(record_->width, level).tiles,
                        down = level_side(record_->height, level).tiles;
    for (std::uint32_t r = 2 * here.row; r < std::min(2 * here.row + 2, down); ++r)
      for (std::uint32_t c = 2 * here.column; c < std::min(2 * here.column + 2, across); ++c)
        stack[count++] = {level, c, r};
  }
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
            [](const BeamState::Tile& a, const BeamState::Tile& b) {
              return a.entry != b.entry ? a.entry < b.entry : a.tile < b.tile;
            });
}

}  // namespace panwright::terrain::internal
