#include "terrain/internal/tile_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/mesh/closest.h"

namespace panwright::terrain::internal {

namespace {

constexpr std::uint32_t kLeafCells = 2, kDepths = 7;  // 2 << 7 cells
static_assert(kLeafCells << kDepths == kTileCells);
constexpr float kFar = std::numeric_limits<float>::max();

// First node of a depth.
constexpr std::uint32_t first_of(std::uint32_t depth) { return ((1u << 2 * depth) - 1) / 3; }

std::uint32_t spread(std::uint32_t v) {
  v = (v | v << 4) & 0x0f0f;
  v = (v | v << 2) & 0x3333;
  return (v | v << 1) & 0x5555;
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
  std::array<float, 3> from, inverse;
};

TileTree::TileTree(const ChartSurface& surface, const TileView& view)
    : surface_(&surface), view_(view), level_(view.record->level) {
  const ChartRecord& chart = surface.record();
  x0_ = view.record->column * kTileCells;
  y0_ = view.record->row * kTileCells;
  nx_ = std::min(kTileCells, level_side(chart.width, level_).posts - 1 - x0_);
  ny_ = std::min(kTileCells, level_side(chart.height, level_).posts - 1 - y0_);
  if (nx_ == 0 || ny_ == 0) return;
  const auto place = [&](std::uint32_t i, std::uint32_t j, double h) {
    return surface.post(level_, x0_ + i, y0_ + j, h);
  };
  const double middle = 0.5 * (double(view.record->low) + double(view.record->high));
  centre_ = place(nx_ / 2, ny_ / 2, middle);
  const Vec3 up = surface.is_plane() ? Vec3(0, 0, 1) : glm::normalize(centre_);
  const Vec3 corner = place(nx_, ny_ / 2, middle);
  Vec3 across = corner - centre_ - glm::dot(corner - centre_, up) * up;
  // of a row at a pole there is no direction
  if (!(glm::dot(across, across) > 0))
    across = std::fabs(up.x) < 0.7 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  across = glm::normalize(across - glm::dot(across, up) * up);
  axes_ = glm::transpose(Mat3(across, glm::cross(up, across), up));
  edge_ = 1e-11 + 2e-9 / std::min(chart.dx, chart.dy);
  build();
}

void TileTree::build() {
  if (surface_->is_costly()) points_.resize(std::size_t{kTilePosts} * kTilePosts);
  nodes_.resize(first_of(kDepths));
  for (Boxes& boxes : nodes_)
    for (std::size_t k = 0; k < 3; ++k) {
      boxes.low[k].fill(kFar);
      boxes.high[k].fill(-kFar);
    }
  // boxes of leaves are those of their posts, which neighbours share: of rows, then of columns
  using Axes = std::array<std::array<float, kTilePosts>, 3>;
  std::vector<Axes> rows(kLeafCells + 1);
  const auto fill = [&](std::uint32_t j) {
    Axes& row = rows[j % (kLeafCells + 1)];
    for (std::uint32_t i = 0; i <= nx_; ++i) {
      const double h = view_.height(i, j);
      Vec3 p = surface_->post(level_, x0_ + i, y0_ + j, h);
      if (!points_.empty()) points_[j * kTilePosts + i] = p;
      p = axes_ * (p - centre_);
      radius_ = std::max(radius_, std::isnan(h) ? 0 : glm::dot(p, p));
      for (std::size_t k = 0; k < 3; ++k) row[k][i] = static_cast<float>(p[static_cast<int>(k)]);
    }
  };
  fill(0);
  Axes low, high;
  for (std::uint32_t y = 0; y < ny_; y += kLeafCells) {
    const std::uint32_t y1 = std::min(y + kLeafCells, ny_);
    for (std::uint32_t j = y + 1; j <= y1; ++j) fill(j);
    for (std::size_t k = 0; k < 3; ++k) {
      low[k].fill(kFar);
      high[k].fill(-kFar);
      for (std::uint32_t j = y; j <= y1; ++j) {
        const auto& row = rows[j % (kLeafCells + 1)][k];
        for (std::uint32_t i = 0; i <= nx_; ++i) {
          // note: comparisons with NaN are false: voids are in no box
          low[k][i] = row[i] < low[k][i] ? row[i] : low[k][i];
          high[k][i] = row[i] > high[k][i] ? row[i] : high[k][i];
        }
      }
    }
    for (std::uint32_t x = 0; x < nx_; x += kLeafCells) {
      const std::uint32_t code = spread(x / kLeafCells) | spread(y / kLeafCells) << 1;
      Boxes& boxes = nodes_[first_of(kDepths - 1) + (code >> 2)];
      const std::uint32_t x1 = std::min(x + kLeafCells, nx_);
      for (std::size_t k = 0; k < 3; ++k) {
        boxes.low[k][code & 3] = *std::min_element(&low[k][x], &low[k][x1] + 1);
        boxes.high[k][code & 3] = *std::max_element(&high[k][x], &high[k][x1] + 1);
      }
    }
  }
  radius_ = std::sqrt(radius_);
  // far more than float rounds by, here and in cast()
  const float pad = static_cast<float>(radius_) * 2e-6f;
  for (std::uint32_t n = first_of(kDepths - 1); n < nodes_.size(); ++n)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 4; ++c)
        if (nodes_[n].low[k][c] <= nodes_[n].high[k][c]) {
          nodes_[n].low[k][c] -= pad;
          nodes_[n].high[k][c] += pad;
        }
  radius_ = radius_ * (1 + 1e-9) + static_cast<double>(pad);
  for (std::uint32_t n = static_cast<std::uint32_t>(nodes_.size()) - 1; n > 0; --n) {
    // children of node n are from 4n + 1 on, by the sum of the depths above
    const std::uint32_t parent = (n - 1) / 4, lane = (n - 1) % 4;
    for (std::size_t k = 0; k < 3; ++k) {
      nodes_[parent].low[k][lane] = *std::ranges::min_element(nodes_[n].low[k]);
      nodes_[parent].high[k][lane] = *std::ranges::max_element(nodes_[n].high[k]);
    }
  }
}

template <class Visit>
void TileTree::visit_leaf(std::uint32_t x, std::uint32_t y, Visit&& visit) const {
  const std::uint32_t x1 = std::min(x + kLeafCells, nx_), y1 = std::min(y + kLeafCells, ny_);
  Vec3 points[kLeafCells + 1][kLeafCells + 1];
  for (std::uint32_t j = y; j <= y1; ++j)
    for (std::uint32_t i = x; i <= x1; ++i)
      points[j - y][i - x] = points_.empty()
                                 ? surface_->post(level_, x0_ + i, y0_ + j, view_.height(i, j))
                                 : points_[j * kTilePosts + i];
  for (std::uint32_t j = 0; j < y1 - y; ++j)
    for (std::uint32_t i = 0; i < x1 - x; ++i) {
      const Vec3 &a = points[j][i], &d = points[j + 1][i + 1];
      for (std::uint32_t which = 0; which < 2; ++which) {
        const Vec3& side = which == 0 ? points[j][i + 1] : points[j + 1][i];
        // counter-clockwise from outside: rows run to the south
        if (visit(a, which == 0 ? d : side, which == 0 ? side : d, x0_ + x + i, y0_ + y + j, which))
          return;
      }
    }
}

void TileTree::meet_leaf(GroundWalk& walk, const Local& local, std::uint32_t x,
                         std::uint32_t y) const {
  visit_leaf(x, y,
             [&](const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t column,
                 std::uint32_t row, std::uint32_t which) {
               double distance;
               // note: of a void corner all comparisons fail
               if (!cross(local.origin, walk.ray.direction, a, b, c, edge_, distance)) return false;
               distance += local.shift;
               if (!(distance >= walk.ray.least && distance < walk.most)) return false;
               const TriangleHit hit{distance, level_, column, row, which, {a, b, c}};
               if (walk.accept != nullptr && !(*walk.accept)(hit)) return false;
               walk.best = hit;
               walk.most = distance;
               return walk.any;
             });
}

void TileTree::approach_leaf(GroundApproach& walk, std::uint32_t x, std::uint32_t y) const {
  visit_leaf(x, y,
             [&](const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t column,
                 std::uint32_t row, std::uint32_t which) {
               const Vec3 nearest = geometry::closest_point({a, b, c}, walk.point);
               const Vec3 offset = nearest - walk.point;
               const double squared = glm::dot(offset, offset);
               // note: false of a void corner
               if (!(squared < walk.squared)) return false;
               TriangleHit hit{std::sqrt(squared), level_, column, row, which, {a, b, c}};
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

// From the nearest box; of boxes in double, however far the point is.
void TileTree::approach(GroundApproach& walk) const {
  if (nodes_.empty()) return;
  struct Entry {
    double squared;
    std::uint32_t node;
    std::uint16_t x, y;
  };
  const Vec3 from = axes_ * (walk.point - centre_);
  std::array<Entry, 3 * kDepths + 4> stack;
  std::size_t count = 0;
  stack[count++] = {0, 0, 0, 0};
  constexpr std::uint32_t kFirstLeaf = first_of(kDepths);
  while (count > 0) {
    const Entry entry = stack[--count];
    if (entry.squared > walk.squared) continue;
    if (entry.node >= kFirstLeaf) {
      approach_leaf(walk, entry.x * kLeafCells, entry.y * kLeafCells);
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

void TileTree::cast(GroundWalk& walk) const {
  if (nodes_.empty()) return;
  Local local;
  const Vec3 to = centre_ - walk.ray.origin;
  local.shift = glm::dot(to, walk.ray.direction);
  local.origin = walk.ray.origin + local.shift * walk.ray.direction;
  const Vec3 from = axes_ * (local.origin - centre_);
  const double left = radius_ * radius_ - glm::dot(from, from);
  if (!(left >= 0)) return;
  const double half = std::sqrt(left);
  const double begin = std::max(walk.ray.least - local.shift, -half);
  if (begin > std::min(walk.most - local.shift, half)) return;
  const Vec3 direction = axes_ * walk.ray.direction;
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    local.from[i] = static_cast<float>(from[k]);
    const auto d = static_cast<float>(direction[k]);
    // finite, so that nothing becomes NaN
    local.inverse[i] = 1 / (std::fabs(d) > 1e-20f ? d : d < 0 ? -1e-20f : 1e-20f);
  }
  // distances are rounded by less than the boxes are padded
  const float slack = static_cast<float>(radius_) * 1e-6f;
  const float least = static_cast<float>(begin) - slack;
  const auto limit = [&] {
    return static_cast<float>(std::min(walk.most - local.shift, half)) + slack;
  };
  float most = limit();
  struct Entry {
    float at;
    std::uint32_t node;  // of depth kDepths: a leaf
    std::uint16_t x, y;  // in squares of its depth
  };
  std::array<Entry, 3 * kDepths + 4> stack;
  std::size_t count = 0;
  stack[count++] = {least, 0, 0, 0};
  constexpr std::uint32_t kFirstLeaf = first_of(kDepths);
  while (count > 0) {
    const Entry entry = stack[--count];
    if (entry.at > most) continue;
    if (entry.node >= kFirstLeaf) {
      meet_leaf(walk, local, entry.x * kLeafCells, entry.y * kLeafCells);
      if (walk.any && walk.best) return;
      most = limit();
      continue;
    }
    const Boxes& boxes = nodes_[entry.node];
    std::array<float, 4> in, out;
    in.fill(least);
    out.fill(most);
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 4; ++c) {
        const float a = (boxes.low[k][c] - local.from[k]) * local.inverse[k];
        const float b = (boxes.high[k][c] - local.from[k]) * local.inverse[k];
        const float low = a < b ? a : b, high = a < b ? b : a;
        in[c] = in[c] > low ? in[c] : low;
        out[c] = out[c] < high ? out[c] : high;
      }
    const std::size_t begin_of = count;
    for (std::uint32_t c = 0; c < 4; ++c) {
      if (!(in[c] <= out[c]) || boxes.low[0][c] > boxes.high[0][c]) continue;
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

}  // namespace panwright::terrain::internal
