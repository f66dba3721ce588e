// Trees of tiles against many rays of one origin.
#include <algorithm>
#include <cmath>

#include "terrain/internal/lanes.h"
#include "terrain/internal/tile_tree.h"

namespace panwright::terrain::internal {

namespace {

// Product of a number with the ends of ranges: the larger one.
inline F4 most(float by, const F4& low, const F4& high) { return by * (by > 0 ? high : low); }

}  // namespace

// Sides of a pyramid, in some axes: points with a negative height over one are outside.
struct TileTree::Sides {
  std::array<std::array<float, 3>, 5> inwards;
  std::array<float, 5> height;  // of the axes' origin

  // Of boxes, a lane each.
  I4 meet(const F4 (&low)[3], const F4 (&high)[3]) const {
    I4 found = I4{} - 1;
    for (std::size_t s = 0; s < 5; ++s)
      found &= height[s] + most(inwards[s][0], low[0], high[0]) +
                   most(inwards[s][1], low[1], high[1]) + most(inwards[s][2], low[2], high[2]) >=
               0;
    return found;
  }
};

void TileTree::find(const RayPyramid& rays, std::vector<SeenSquare>& out) const {
  if (nodes_.empty()) return;
  const Vec3 to = centre_ - rays.origin;
  Sides sides;
  Vec3 ahead;
  for (std::size_t s = 0; s < 5; ++s) {
    const Vec3& side = s < 4 ? rays.inwards[s] : rays.axis;
    const double height = glm::dot(side, to);
    if (height < -1.001 * radius_) return;
    if (s == 4) ahead = axes_ * side;
    for (int k = 0; k < 3; ++k)
      sides.inwards[s][static_cast<std::size_t>(k)] = static_cast<float>((axes_ * side)[k]);
    sides.height[s] = static_cast<float>(height + 1e-5 * (radius_ + std::fabs(height)));
  }
  const double distance = glm::dot(rays.axis, to);
  constexpr std::uint32_t kFirstSquare = first_of(kSquareDepth);
  std::array<std::uint32_t, 3 * kSquareDepth + 4> stack;
  std::size_t count = 0;
  stack[count++] = 0;
  while (count > 0) {
    const std::uint32_t node = stack[--count];
    const Boxes& boxes = nodes_[node];
    const F4 low[3] = {lanes(boxes.low[0]), lanes(boxes.low[1]), lanes(boxes.low[2])},
             high[3] = {lanes(boxes.high[0]), lanes(boxes.high[1]), lanes(boxes.high[2])};
    const I4 found = sides.meet(low, high) & (low[0] <= high[0]);
    for (std::uint32_t c = 0; c < 4; ++c) {
      if (!found[c]) continue;
      const std::uint32_t child = 4 * node + 1 + c;
      if (child < kFirstSquare) {
        stack[count++] = child;
        continue;
      }
      double least = distance - 1e-5 * radius_;
      for (std::size_t k = 0; k < 3; ++k) {
        const double by = ahead[static_cast<int>(k)];
        least += by * double(by > 0 ? low[k][c] : high[k][c]);
      }
      out.push_back({least, static_cast<std::uint8_t>(child - kFirstSquare)});
    }
  }
}

double TileTree::rays_of_leaf(const RayGrid& rays, const SeenSquare& seen) const {
  const auto& [across, down, up] = squares_[seen.code].from;
  const auto vec = [](const std::array<float, 3>& a) { return Vec3(a[0], a[1], a[2]); };
  const double area = glm::dot(glm::cross(vec(across), vec(down)), axes_ * rays.pyramid().axis);
  const double away = std::max(seen.ahead, 1e-3);
  return rays.density() * std::fabs(area) * (kLeafCells * kLeafCells) / (away * away);
}

std::size_t TileTree::cast(RayGrid& rays, std::uint32_t tile, std::uint8_t code,
                           const AcceptPoint* accepts) const {
  const Square& square = squares_[code];
  const std::uint32_t left = gather(code) * kSquareCells,
                      top = gather(std::uint32_t{code} >> 1) * kSquareCells;
  const Vec3 to = centre_ - rays.pyramid().origin;
  Sides sides;
  for (std::size_t s = 0; s < 5; ++s) {
    const Vec3& side = s < 4 ? rays.pyramid().inwards[s] : rays.pyramid().axis;
    const Vec3 inwards = axes_ * side;
    double height = glm::dot(side, to);
    height += 1e-5 * (radius_ + std::fabs(height));
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = static_cast<int>(k);
      height += inwards[i] * double(square.origin[k]);
      double along = 0;
      for (std::size_t m = 0; m < 3; ++m)
        along += double(square.from[k][m]) * inwards[static_cast<int>(m)];
      sides.inwards[s][k] = static_cast<float>(along);
    }
    sides.height[s] = static_cast<float>(height);
  }
  std::size_t leaves = 0;
  struct Entry {
    std::uint32_t code;
    std::uint16_t depth, x, y;  // cell of the square
  };
  std::array<Entry, 3 * 3 + 4> stack;
  std::size_t count = 0;
  stack[count++] = {code, kSquareDepth, 0, 0};
  while (count > 0) {
    const Entry entry = stack[--count];
    if (entry.depth == kSquareDepth + 3) {
      cast_leaf(rays, tile, left + entry.x, top + entry.y, accepts);
      ++leaves;
      continue;
    }
    const std::uint32_t half = kSquareCells >> (entry.depth - kSquareDepth + 1);
    const auto cells = static_cast<float>(half);
    constexpr F4 kRight = {0, 1, 0, 1}, kDown = {0, 0, 1, 1};
    const Heights& heights = heights_[heights_at(entry.depth, entry.code)];
    const F4 x = entry.x + cells * kRight, y = entry.y + cells * kDown;
    const F4 low[3] = {x - square.pad[0], y - square.pad[1], lanes(heights.low) - square.pad[2]},
             high[3] = {x + (cells + square.pad[0]), y + (cells + square.pad[1]),
                        lanes(heights.high) + square.pad[2]};
    I4 found = lanes(heights.low) <= lanes(heights.high);
    if (!square.loose) found &= sides.meet(low, high);
    for (std::uint32_t c = 0; c < 4; ++c)
      if (found[c])
        stack[count++] = {4 * entry.code + c, static_cast<std::uint16_t>(entry.depth + 1),
                          static_cast<std::uint16_t>(entry.x + half * (c & 1)),
                          static_cast<std::uint16_t>(entry.y + half * (c >> 1))};
  }
  return leaves;
}

void TileTree::cast_leaf(RayGrid& rays, std::uint32_t tile, std::uint32_t left, std::uint32_t top,
                         const AcceptPoint* accepts) const {
  const std::uint32_t columns = std::min(kLeafCells, nx_ - left),
                      rows = std::min(kLeafCells, ny_ - top);
  Vec3 posts[(kLeafCells + 1) * (kLeafCells + 1)];
  if (points_.empty()) {
    const auto height = [&](std::uint32_t i, std::uint32_t j) {
      return height_of(view_, left + i, top + j);
    };
    surface_->posts(level_, x0_ + left, y0_ + top, columns + 1, rows + 1, height, posts);
  } else {
    Vec3* out = posts;
    for (std::uint32_t j = 0; j <= rows; ++j)
      for (std::uint32_t i = 0; i <= columns; ++i)
        *out++ = points_[(top + j) * kTilePosts + left + i];
  }
  SeenPost seen[(kLeafCells + 1) * (kLeafCells + 1)];
  for (std::uint32_t k = 0; k < (columns + 1) * (rows + 1); ++k) seen[k] = rays.seen(posts[k]);
  // the exact test decides at edges
  const double edge = 2 * edge_ + 1e-12;
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      const SeenPost *a = &seen[j * (columns + 1) + i], *c = a + columns + 1;
      const RayGrid::Cell cell{tile, static_cast<std::uint16_t>(left + i),
                               static_cast<std::uint16_t>(top + j)};
      rays.meet(a[0], c[1], a[1], edge, cell, accepts);
      rays.meet(a[0], c[0], c[1], edge, cell, accepts);
    }
}

}  // namespace panwright::terrain::internal
