#include "terrain/internal/tile_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/mesh/closest.h"
#include "terrain/internal/lanes.h"

namespace panwright::terrain::internal {

namespace {

// Narrows the parts of rays to those between two planes.
inline void narrow(const F4& a, const F4& b, F4& in, F4& out) {
  const F4 low = a < b ? a : b, high = a < b ? b : a;
  in = in > low ? in : low;
  out = out < high ? out : high;
}

// Distance at which a ray meets a triangle, from either side; its edges are widened by a share.
bool cross(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c,
           double edge, double& distance) {
  const Vec3 ab = b - a, ac = c - a;
  const Vec3 p = glm::cross(direction, ac);
  const double det = glm::dot(ab, p);
  if (det == 0) return false;
  const double inverse = 1 / det;
  const Vec3 from = origin - a;
  const double u = glm::dot(from, p) * inverse;
  if (!(u >= -edge && u <= 1 + edge)) return false;
  const Vec3 q = glm::cross(from, ab);
  const double v = glm::dot(direction, q) * inverse;
  if (v < -edge || u + v > 1 + edge) return false;
  distance = glm::dot(ac, q) * inverse;
  return true;
}

}  // namespace

// Ray in the axes of the tile, its origin the place nearest to the middle.
struct TileTree::Local {
  Vec3 origin;  // body-fixed
  double shift;
  std::array<float, 3> from, direction, inverse;
  float least;
  double half;  // metres: of the way through the sphere about the posts
  float slack;  // distances are rounded by less than boxes are padded

  void set(const Vec3& at, const Vec3& ahead) {
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      from[i] = static_cast<float>(at[k]);
      const auto d = static_cast<float>(ahead[k]);
      direction[i] = d;
      // finite, so that nothing becomes NaN
      inverse[i] = 1 / (std::fabs(d) > 1e-20f ? d : d < 0 ? -1e-20f : 1e-20f);
    }
  }
  // Narrows parts of the ray to those in boxes, widened, and returns whether any is left.
  I4 meet(const Boxes& boxes, float wider, F4& in, F4& out) const {
    for (std::size_t k = 0; k < 3; ++k)
      narrow((lanes(boxes.low[k]) - (from[k] + wider)) * inverse[k],
             (lanes(boxes.high[k]) - (from[k] - wider)) * inverse[k], in, out);
    return (in <= out) & (lanes(boxes.low[0]) <= lanes(boxes.high[0]));
  }
  // of a walk
  float most(const GroundWalk& walk) const {
    return static_cast<float>(std::min(walk.most - shift, half)) + slack;
  }
};

// Ray in the axes of a square.
struct TileTree::SquareRay {
  std::array<float, 3> from, inverse;
  std::array<float, 3> pad;
  float least, most;
  std::uint32_t x, y;  // first cell of the square
  std::array<float, 3> direction;
  float lean;
  bool even;  // steps of posts are those of its cells

  // Whether it rises faster than ground with steps, metres, along its cells.
  bool rises_over(float across, float down) const {
    return direction[2] > lean + std::fabs(direction[0]) * across + std::fabs(direction[1]) * down;
  }

  // Sets where the ray is in boxes, a lane each, and returns whether it is.
  //
  //   cells  on a side of a box; x_at, y_at: cell of the first, in the square
  I4 meet(const Heights& heights, float cells, float x_at, float y_at, F4& in) const {
    constexpr F4 kRight = {0, 1, 0, 1}, kDown = {0, 0, 1, 1};
    const F4 low = lanes(heights.low), high = lanes(heights.high);
    const F4 x = x_at + cells * kRight - from[0], y = y_at + cells * kDown - from[1];
    F4 out = F4{} + most;
    in = F4{} + least;
    narrow((x - pad[0]) * inverse[0], (x + (cells + pad[0])) * inverse[0], in, out);
    narrow((y - pad[1]) * inverse[1], (y + (cells + pad[1])) * inverse[1], in, out);
    narrow((low - (pad[2] + from[2])) * inverse[2], (high + (pad[2] - from[2])) * inverse[2], in,
           out);
    return (in <= out) & (low <= high);
  }
};

template <class Visit>
bool TileTree::visit_cell(std::uint32_t x, std::uint32_t y, Visit&& visit) const {
  const auto visit_both = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    // counter-clockwise from outside: rows run to the south
    return visit(a, d, b, 0u) || visit(a, c, d, 1u);
  };
  if (!points_.empty()) {
    const Vec3* const row = &points_[y * kTilePosts + x];
    return visit_both(row[0], row[1], row[kTilePosts], row[kTilePosts + 1]);
  }
  const auto height = [&](std::uint32_t i, std::uint32_t j) {
    return height_of(view_, x + i, y + j);
  };
  const auto& [a, b, c, d] = surface_->cell(level_, x0_ + x, y0_ + y, height).posts;
  return visit_both(a, b, c, d);
}

void TileTree::meet_cell(GroundWalk& walk, const Local& local, std::uint32_t x,
                         std::uint32_t y) const {
  visit_cell(x, y, [&](const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t which) {
    double distance;
    // note: of a void corner all comparisons fail
    if (!cross(local.origin, walk.ray.direction, a, b, c, edge_, distance)) return false;
    distance += local.shift;
    if (!(distance >= walk.ray.least && distance < walk.most)) return false;
    const TriangleHit hit{distance, level_, x0_ + x, y0_ + y, which, {a, b, c}};
    if (walk.accept != nullptr && !(*walk.accept)(hit)) return false;
    walk.best = hit;
    walk.most = distance;
    return walk.any;
  });
}

// Cells of a leaf by their own heights.
void TileTree::meet_leaf(GroundWalk& walk, const Local& local, const SquareRay& ray,
                         std::uint32_t x, std::uint32_t y) const {
  const std::uint32_t left = ray.x + x, top = ray.y + y;
  const std::uint32_t columns = std::min(kLeafCells, nx_ - left),
                      rows = std::min(kLeafCells, ny_ - top);
  float posts[kLeafCells + 1][kLeafCells + 1];
  for (std::uint32_t j = 0; j <= rows; ++j)
    for (std::uint32_t i = 0; i <= columns; ++i)
      posts[j][i] = static_cast<float>(height_of(view_, left + i, top + j) - middle_);
  Heights heights;
  heights.low.fill(kFar);
  heights.high.fill(-kFar);
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i)
      for (const float h : {posts[j][i], posts[j][i + 1], posts[j + 1][i], posts[j + 1][i + 1]}) {
        float &low = heights.low[2 * j + i], &high = heights.high[2 * j + i];
        low = h < low ? h : low;
        high = h > high ? h : high;
      }
  F4 in;
  const I4 found = ray.meet(heights, 1, static_cast<float>(x), static_cast<float>(y), in);
  if (walk.leaves_ground && ray.even && (found[0] | found[1] | found[2] | found[3]) != 0) {
    // as of its square, by its own steps
    float across = 0, down = 0;
    for (std::uint32_t j = 0; j <= rows; ++j)
      for (std::uint32_t i = 0; i <= columns; ++i) {
        if (i < columns) across = std::max(across, std::fabs(posts[j][i + 1] - posts[j][i]));
        if (j < rows) down = std::max(down, std::fabs(posts[j + 1][i] - posts[j][i]));
      }
    if (ray.rises_over(kUneven * across, kUneven * down)) return;
  }
  for (std::uint32_t c = 0; c < 4; ++c) {
    if (!found[c]) continue;
    meet_cell(walk, local, left + c % 2, top + c / 2);
    if (walk.any && walk.best) return;
  }
}

void TileTree::cast_square(GroundWalk& walk, const Local& local, std::uint32_t code,
                           std::uint32_t x, std::uint32_t y, float most) const {
  const Square& square = squares_[code];
  if (square.loose) {
    for (std::uint32_t j = y; j < std::min(y + kSquareCells, ny_); ++j)
      for (std::uint32_t i = x; i < std::min(x + kSquareCells, nx_); ++i) {
        meet_cell(walk, local, i, j);
        if (walk.any && walk.best) return;
      }
    return;
  }
  SquareRay ray;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& to = square.to[k];
    ray.from[k] = to[0] * (local.from[0] - square.origin[0]) +
                  to[1] * (local.from[1] - square.origin[1]) +
                  to[2] * (local.from[2] - square.origin[2]);
    const float d = ray.direction[k] =
        to[0] * local.direction[0] + to[1] * local.direction[1] + to[2] * local.direction[2];
    // finite, so that nothing becomes NaN
    ray.inverse[k] = 1 / (std::fabs(d) > 1e-20f ? d : d < 0 ? -1e-20f : 1e-20f);
  }
  ray.lean = square.lean;
  ray.even = square.steps[0] < kFar && square.steps[1] < kFar;
  if (walk.leaves_ground && ray.rises_over(square.steps[0], square.steps[1])) return;
  ray.pad = square.pad;
  ray.least = local.least;
  ray.most = most;
  ray.x = x;
  ray.y = y;
  struct Entry {
    float at;
    std::uint32_t code;
    std::uint16_t depth, x, y;  // cell of the square
  };
  std::array<Entry, 3 * 3 + 4> stack;
  std::size_t count = 0;
  stack[count++] = {local.least, code, kSquareDepth, 0, 0};
  while (count > 0) {
    const Entry entry = stack[--count];
    if (entry.at > ray.most) continue;
    if (entry.depth == kSquareDepth + 3) {
      meet_leaf(walk, local, ray, entry.x, entry.y);
      if (walk.any && walk.best) return;
      ray.most = local.most(walk);
      continue;
    }
    const std::uint32_t half = kSquareCells >> (entry.depth - kSquareDepth + 1);
    F4 in;
    const I4 found =
        ray.meet(heights_[heights_at(entry.depth, entry.code)], static_cast<float>(half),
                 static_cast<float>(entry.x), static_cast<float>(entry.y), in);
    const std::size_t begin = count;
    for (std::uint32_t c = 0; c < 4; ++c) {
      if (!found[c]) continue;
      const Entry child{in[c], 4 * entry.code + c, static_cast<std::uint16_t>(entry.depth + 1),
                        static_cast<std::uint16_t>(entry.x + half * (c & 1)),
                        static_cast<std::uint16_t>(entry.y + half * (c >> 1))};
      // the nearest last
      std::size_t at = count++;
      for (; at > begin && stack[at - 1].at < child.at; --at) stack[at] = stack[at - 1];
      stack[at] = child;
    }
  }
}

void TileTree::approach_cell(GroundApproach& walk, std::uint32_t x, std::uint32_t y) const {
  visit_cell(x, y, [&](const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t which) {
    const Vec3 nearest = geometry::closest_point({a, b, c}, walk.point);
    const Vec3 offset = nearest - walk.point;
    const double squared = glm::dot(offset, offset);
    // note: false of a void corner
    if (!(squared < walk.squared)) return false;
    const TriangleHit hit{std::sqrt(squared), level_, x0_ + x, y0_ + y, which, {a, b, c}};
    const Vec3 before = std::exchange(walk.nearest, nearest);
    if (walk.accept != nullptr && !(*walk.accept)(hit)) {
      walk.nearest = before;
      return false;
    }
    walk.best = hit;
    walk.squared = squared;
    return false;
  });
}

// Leaves of a square by boxes in the axes of the tile.
void TileTree::approach_square(GroundApproach& walk, const Vec3& from, std::uint32_t code,
                               std::uint32_t x, std::uint32_t y) const {
  const Square& square = squares_[code];
  constexpr std::uint32_t kLeaves = kSquareCells / kLeafCells;
  for (std::uint32_t leaf = 0; leaf < kLeaves * kLeaves; ++leaf) {
    const std::uint32_t inner = 64 * code + leaf;
    const Heights& heights = heights_[heights_at(kSquareDepth + 2, inner >> 2)];
    const double low = double(heights.low[inner & 3]), high = double(heights.high[inner & 3]);
    if (!(low <= high)) continue;
    const std::uint32_t i = kLeafCells * gather(leaf), j = kLeafCells * gather(leaf >> 1);
    const double half[3] = {0.5 * kLeafCells + double(square.pad[0]),
                            0.5 * kLeafCells + double(square.pad[1]),
                            0.5 * (high - low) + double(square.pad[2])};
    const double middle[3] = {i + 0.5 * kLeafCells, j + 0.5 * kLeafCells, 0.5 * (low + high)};
    double squared = 0;
    for (std::size_t k = 0; k < 3 && !square.loose; ++k) {
      double at = double(square.origin[k]), reach = 0;
      for (std::size_t m = 0; m < 3; ++m) {
        at += middle[m] * double(square.from[m][k]);
        reach += half[m] * std::fabs(double(square.from[m][k]));
      }
      const double off = std::max(std::fabs(from[static_cast<int>(k)] - at) - reach, 0.0);
      squared += off * off;
    }
    if (squared > walk.squared) continue;
    for (std::uint32_t b = y + j; b < std::min(y + j + kLeafCells, ny_); ++b)
      for (std::uint32_t a = x + i; a < std::min(x + i + kLeafCells, nx_); ++a)
        approach_cell(walk, a, b);
  }
}

// From the nearest box; of boxes in double, however far the point is.
void TileTree::approach(GroundApproach& walk) const {
  if (nodes_.empty()) return;
  struct Entry {
    double squared;
    std::uint32_t node;
    std::uint16_t x, y;
  };
  const Vec3 from = axes_ * (walk.point - centre_);
  std::array<Entry, 3 * kSquareDepth + 4> stack;
  std::size_t count = 0;
  stack[count++] = {0, 0, 0, 0};
  constexpr std::uint32_t kFirstSquare = first_of(kSquareDepth);
  while (count > 0) {
    const Entry entry = stack[--count];
    if (entry.squared > walk.squared) continue;
    if (entry.node >= kFirstSquare) {
      approach_square(walk, from, entry.node - kFirstSquare, entry.x * kSquareCells,
                      entry.y * kSquareCells);
      continue;
    }
    const Boxes& boxes = nodes_[entry.node];
    const std::size_t begin_of = count;
    for (std::uint32_t c = 0; c < 4; ++c) {
      if (boxes.low[0][c] > boxes.high[0][c]) continue;
      double squared = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double at = from[static_cast<int>(k)];
        const double off =
            std::max({double(boxes.low[k][c]) - at, at - double(boxes.high[k][c]), 0.0});
        squared += off * off;
      }
      if (squared > walk.squared) continue;
      const Entry child{squared, 4 * entry.node + 1 + c,
                        static_cast<std::uint16_t>(2 * entry.x + (c & 1)),
                        static_cast<std::uint16_t>(2 * entry.y + (c >> 1))};
      // the nearest last
      std::size_t at = count++;
      for (; at > begin_of && stack[at - 1].squared < child.squared; --at)
        stack[at] = stack[at - 1];
      stack[at] = child;
    }
  }
}

bool TileTree::place(const GroundWalk& walk, Local& local) const {
  if (nodes_.empty()) return false;
  // the third row of the axes is the vertical
  const Vec3& ahead = walk.ray.direction;
  if (walk.leaves_ground &&
      axes_[0].z * ahead.x + axes_[1].z * ahead.y + axes_[2].z * ahead.z > steepest_)
    return false;
  const Vec3 to = centre_ - walk.ray.origin;
  local.shift = glm::dot(to, walk.ray.direction);
  local.origin = walk.ray.origin + local.shift * walk.ray.direction;
  const Vec3 from = axes_ * (local.origin - centre_);
  const double left = radius_ * radius_ - glm::dot(from, from);
  if (!(left >= 0)) return false;
  const double half = std::sqrt(left);
  const double begin = std::max(walk.ray.least - local.shift, -half);
  if (begin > std::min(walk.most - local.shift, half)) return false;
  local.half = half;
  local.set(from, axes_ * walk.ray.direction);
  local.slack = static_cast<float>(radius_) * 1e-6f;
  local.least = static_cast<float>(begin) - local.slack;
  return true;
}

void TileTree::cast(GroundWalk& walk) const {
  Local local;
  if (!place(walk, local)) return;
  float most = local.most(walk);
  struct Entry {
    float at;
    std::uint32_t node;  // of kSquareDepth: a square
    std::uint16_t x, y;  // in squares of its depth
  };
  std::array<Entry, 3 * kSquareDepth + 4> stack;
  std::size_t count = 0;
  stack[count++] = {local.least, 0, 0, 0};
  constexpr std::uint32_t kFirstSquare = first_of(kSquareDepth);
  while (count > 0) {
    const Entry entry = stack[--count];
    if (entry.at > most) continue;
    if (entry.node >= kFirstSquare) {
      cast_square(walk, local, entry.node - kFirstSquare, entry.x * kSquareCells,
                  entry.y * kSquareCells, most);
      if (walk.any && walk.best) return;
      most = local.most(walk);
      continue;
    }
    const Boxes& boxes = nodes_[entry.node];
    F4 in = F4{} + local.least, out = F4{} + most;
    const I4 found = local.meet(boxes, 0, in, out);
    const std::size_t begin_of = count;
    for (std::uint32_t c = 0; c < 4; ++c) {
      if (!found[c]) continue;
      const Entry child{in[c], 4 * entry.node + 1 + c,
                        static_cast<std::uint16_t>(2 * entry.x + (c & 1)),
                        static_cast<std::uint16_t>(2 * entry.y + (c >> 1))};
      // the nearest last
      std::size_t at = count++;
      for (; at > begin_of && stack[at - 1].at < child.at; --at) stack[at] = stack[at - 1];
      stack[at] = child;
    }
  }
}

void TileTree::cast(GroundWalk& walk, std::span<const std::uint8_t> squares) const {
  Local local;
  if (!place(walk, local)) return;
  for (const std::uint8_t code : squares) {
    F4 in = F4{} + local.least, out = F4{} + local.most(walk);
    const float most = out[0];
    if (squares.size() > 1 &&
        !local.meet(nodes_[first_of(kSquareDepth - 1) + (code >> 2)], 0, in, out)[code & 3])
      continue;
    cast_square(walk, local, code, gather(code) * kSquareCells, gather(code >> 1) * kSquareCells,
                most);
    if (walk.any && walk.best) return;
  }
}

bool TileTree::falls_behind(const Square& square, const std::array<float, 3>& axis,
                            double sine) const {
  float rise = square.lean;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& to = square.to[k];
    const float along = to[0] * axis[0] + to[1] * axis[1] + to[2] * axis[2];
    const float turn =
        static_cast<float>(1.04 * sine) * std::sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
    if (k == 2) return along - turn > rise;
    rise += (std::fabs(along) + turn) * square.steps[k];
  }
  return false;
}

void TileTree::cast(GroundWalk& walk, std::uint32_t x, std::uint32_t y) const {
  Local local;
  local.shift = glm::dot(centre_ - walk.ray.origin, walk.ray.direction);
  local.origin = walk.ray.origin + local.shift * walk.ray.direction;
  meet_cell(walk, local, x, y);
}

// Boxes are widened by what rays of the beam are off its axis, there where they are farthest.
void TileTree::find(const TerrainBeam& beam, std::vector<std::uint8_t>& out) const {
  if (nodes_.empty()) return;
  const Vec3 direction = axes_ * beam.axis, to = centre_ - beam.origin;
  // unit vectors differ by 2 sin of half their angle
  if (beam.leaves_ground && direction.z - 1.04 * beam.sine > steepest_) return;
  Local local;
  local.shift = glm::dot(to, beam.axis);
  const Vec3 from = -(axes_ * (to - local.shift * beam.axis));
  const double farthest = std::sqrt(glm::dot(to, to)) + radius_ + beam.radius;
  const double within = 1.001 * (beam.radius + farthest * beam.sine) + 1e-5 * radius_;
  const double reach = radius_ + 1.8 * within;
  const double left = reach * reach - glm::dot(from, from);
  if (!(left >= 0) || local.shift < -reach) return;
  local.set(from, direction);
  const auto least = static_cast<float>(std::max(-local.shift - 1e-5 * radius_, -reach)),
             most = static_cast<float>(reach);
  struct Entry {
    float at;
    std::uint32_t node;
  };
  std::array<Entry, 3 * kSquareDepth + 4> stack;
  std::size_t count = 0;
  stack[count++] = {least, 0};
  constexpr std::uint32_t kFirstSquare = first_of(kSquareDepth);
  while (count > 0) {
    const Entry entry = stack[--count];
    if (entry.node >= kFirstSquare) {
      const std::uint32_t code = entry.node - kFirstSquare;
      const Square& square = squares_[code];
      if (!beam.leaves_ground || square.loose || !falls_behind(square, local.direction, beam.sine))
        out.push_back(static_cast<std::uint8_t>(code));
      continue;
    }
    F4 in = F4{} + least, until = F4{} + most;
    const I4 found = local.meet(nodes_[entry.node], static_cast<float>(within), in, until);
    const std::size_t begin_of = count;
    for (std::uint32_t c = 0; c < 4; ++c) {
      if (!found[c]) continue;
      const Entry child{in[c], 4 * entry.node + 1 + c};
      // the nearest last
      std::size_t at = count++;
      for (; at > begin_of && stack[at - 1].at < child.at; --at) stack[at] = stack[at - 1];
      stack[at] = child;
    }
  }
}

}  // namespace panwright::terrain::internal
