// What trees of tiles hold.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/axis_box.h"
#include "terrain/internal/tile_tree.h"

namespace panwright::terrain::internal {

// Corners of the squares in the axes of the tile, at the middle height, and their verticals.
struct TileTree::Lattice {
  Vec3 points[kSquares + 1][kSquares + 1], verticals[kSquares + 1][kSquares + 1];
  double up = 0;  // metres: of the lattice's height
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
  middle_ = 0.5 * (double(view.record->low) + double(view.record->high));
  centre_ = place(nx_ / 2, ny_ / 2, middle_);
  const Vec3 up = surface.is_plane() ? Vec3(0, 0, 1) : glm::normalize(centre_);
  const Vec3 corner = place(nx_, ny_ / 2, middle_);
  Vec3 across = corner - centre_ - glm::dot(corner - centre_, up) * up;
  // of a row at a pole there is no direction
  if (!(glm::dot(across, across) > 0))
    across = std::fabs(up.x) < 0.7 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  across = glm::normalize(across - glm::dot(across, up) * up);
  axes_ = glm::transpose(Mat3(across, glm::cross(up, across), up));
  edge_ = 1e-11 + 2e-9 / std::min(chart.dx, chart.dy);
  build();
}

// Largest steps between neighbouring posts of a row of squares.
struct TileTree::Steps {
  using Row = std::array<float, kTilePosts>;
  Row across, down, voids;  // voids: 0, or NaN

  void clear() {
    across.fill(0);
    down.fill(0);
    voids.fill(0);
  }
  void add(const Row& row, std::uint32_t cells) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const float step = std::fabs(row[i + 1] - row[i]);
      across[i] = step > across[i] ? step : across[i];
    }
    for (std::uint32_t i = 0; i <= cells; ++i) voids[i] += row[i] - row[i];
  }
  void add(const Row& row, const Row& next, std::uint32_t cells) {
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const float step = std::fabs(next[i] - row[i]);
      down[i] = step > down[i] ? step : down[i];
    }
  }
  std::array<float, 2> of(std::uint32_t first, std::uint32_t end) const {
    float none = 0;
    for (std::uint32_t i = first; i <= end; ++i) none += voids[i];
    if (!(none == 0)) return {kFar, kFar};
    return {*std::max_element(&across[first], &across[end]),
            *std::max_element(&down[first], &down[end] + 1)};
  }
};

// Heights of 2 x 2 cells are those of their posts, which neighbours share: of rows, then of
// columns.
void TileTree::build_heights() {
  heights_.reset(new Heights[kHeightNodes]);
  for (Heights* node = heights_.get(); node != heights_.get() + kHeightNodes; ++node) {
    node->low.fill(kFar);
    node->high.fill(-kFar);
  }
  using Row = std::array<float, kTilePosts>;
  Row rows[kLeafCells + 1], low, high;
  const auto fill = [&](std::uint32_t j) {
    Row& row = rows[j % (kLeafCells + 1)];
    for (std::uint32_t i = 0; i <= nx_; ++i)
      row[i] = static_cast<float>(height_of(view_, i, j) - middle_);
  };
  fill(0);
  Steps steps;
  steps.clear();
  for (std::uint32_t y = 0; y < ny_; y += kLeafCells) {
    low.fill(kFar);
    high.fill(-kFar);
    const std::uint32_t y1 = std::min(y + kLeafCells, ny_);
    for (std::uint32_t j = y + 1; j <= y1; ++j) fill(j);
    for (std::uint32_t j = y; j <= y1; ++j) {
      const Row& row = rows[j % (kLeafCells + 1)];
      steps.add(row, nx_);
      if (j < y1) steps.add(row, rows[(j + 1) % (kLeafCells + 1)], nx_);
      for (std::uint32_t i = 0; i <= nx_; ++i) {
        // note: comparisons with NaN are false: voids are in no box
        low[i] = row[i] < low[i] ? row[i] : low[i];
        high[i] = row[i] > high[i] ? row[i] : high[i];
      }
    }
    for (std::uint32_t x = 0; x < nx_; x += kLeafCells) {
      const std::uint32_t code = spread(x / kLeafCells) | spread(y / kLeafCells) << 1;
      Heights& node = heights_[heights_at(kSquareDepth + 2, code >> 2)];
      const std::uint32_t x1 = std::min(x + kLeafCells, nx_);
      node.low[code & 3] = std::min({low[x], low[x + 1], low[x1]});
      node.high[code & 3] = std::max({high[x], high[x + 1], high[x1]});
    }
    if (y1 % kSquareCells != 0 && y1 != ny_) continue;
    for (std::uint32_t x = 0; x < nx_; x += kSquareCells)
      squares_[spread(x / kSquareCells) | spread(y / kSquareCells) << 1].steps =
          steps.of(x, std::min(x + kSquareCells, nx_));
    steps.clear();
  }
  fold_heights();
}

void TileTree::fold_heights() {
  for (std::uint32_t depth = kSquareDepth + 1; depth >= kSquareDepth; --depth)
    for (std::uint32_t code = 0; code < 1u << 2 * depth; ++code)
      for (std::uint32_t c = 0; c < 4; ++c) {
        const Heights& child = heights_[heights_at(depth + 1, 4 * code + c)];
        Heights& node = heights_[heights_at(depth, code)];
        node.low[c] = *std::ranges::min_element(child.low);
        node.high[c] = *std::ranges::max_element(child.high);
      }
}

// Sets the axes of a square, and returns the box about its posts.
//
// Its ground is the bilinear interpolation of its corners, but for its bend, and moves along
// verticals that differ from that in the middle.
AxisBox TileTree::build_square(const Lattice& lattice, std::uint32_t x, std::uint32_t y) {
  const std::uint32_t code = spread(x) | spread(y) << 1;
  const Heights& heights = heights_[heights_at(kSquareDepth, code)];
  const double low = double(*std::ranges::min_element(heights.low)),
               high = double(*std::ranges::max_element(heights.high));
  AxisBox box;
  if (!(low <= high)) return box;
  const double nx = std::min(kSquareCells, nx_ - x * kSquareCells),
               ny = std::min(kSquareCells, ny_ - y * kSquareCells);
  const double posts = std::ldexp(1.0, static_cast<int>(level_));
  const ChartRecord& chart = surface_->record();
  const double bend = surface_->bend(nx * posts, ny * posts, middle_ + high);
  Vec3 mean(0), vertical(0);
  for (std::uint32_t c = 0; c < 4; ++c) {
    const Vec3 &p = lattice.points[y + c / 2][x + c % 2],
               &n = lattice.verticals[y + c / 2][x + c % 2];
    box.add(p + low * n);
    box.add(p + high * n);
    mean += 0.25 * p;
    vertical += 0.25 * n;
  }
  const double rounding = radius_ * 2e-6;
  box.widen(bend + rounding);
  const auto side = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    const auto at = [&](std::uint32_t k) { return lattice.points[y + k / 2][x + k % 2]; };
    return 0.5 * (at(b) - at(a) + at(d) - at(c));
  };
  const Vec3 across = side(0, 1, 2, 3) / nx, down = side(0, 2, 1, 3) / ny;
  const Mat3 from(across, down, vertical), to = glm::inverse(from);
  const Vec3 origin = mean - 0.5 * (nx * across + ny * down);
  // the last post of a level may be nearer to the one before
  const auto is_short = [&](std::uint32_t first, double cells, std::uint32_t total) {
    return (first + cells) * posts > double(total - 1);
  };
  const double uneven[3] = {is_short(x0_ + x * kSquareCells, nx, chart.width) ? 1.0 : 0.0,
                            is_short(y0_ + y * kSquareCells, ny, chart.height) ? 1.0 : 0.0, 0};
  Square& square = squares_[code];
  double slope = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 row(to[0][k], to[1][k], to[2][k]);
    const double length = std::sqrt(glm::dot(row, row));
    double off = 0, tilt = 0;
    for (std::uint32_t c = 0; c < 4; ++c) {
      const Vec3 error = lattice.points[y + c / 2][x + c % 2] -
                         (origin + (c % 2) * nx * across + (c / 2) * ny * down);
      const Vec3 turn = lattice.verticals[y + c / 2][x + c % 2] - vertical;
      off = std::max(off, std::fabs(glm::dot(row, error)));
      tilt = std::max(tilt, std::sqrt(glm::dot(turn, turn)));
    }
    const double turned = tilt + bend / surface_->bend_radius();
    const double pad = off + length * (bend + rounding + std::max(-low, high) * turned) +
                       uneven[k] + 2e-3 * (k < 2);
    const auto i = static_cast<std::size_t>(k);
    square.pad[i] = static_cast<float>(pad * (1 + 1e-6));
    square.origin[i] = static_cast<float>(origin[k]);
    for (int j = 0; j < 3; ++j) {
      square.to[i][static_cast<std::size_t>(j)] = static_cast<float>(row[j]);
      square.from[i][static_cast<std::size_t>(j)] = static_cast<float>(from[k][j]);
    }
    if (k < 2) {
      // cells differ by less than a tenth where posts lie near these axes
      square.steps[i] = pad < 0.3 ? kUneven * square.steps[i] : kFar;
      slope += length * double(square.steps[i]);
    } else {
      const double lean = 2 * turned + 1e-3;
      const Vec3 aside = row - Vec3(0, 0, 1);
      steepest_ = std::max(steepest_, slope + lean + std::sqrt(glm::dot(aside, aside)));
      square.lean = static_cast<float>(lean);
    }
    // false for what is not a number
    square.loose = square.loose || !(k == 2 || pad < kSquareCells) || !(length < 1e9);
  }
  return box;
}

void TileTree::build() {
  if (surface_->is_costly()) {
    points_.resize(std::size_t{kTilePosts} * kTilePosts);
    for (std::uint32_t j = 0; j <= ny_; ++j)
      for (std::uint32_t i = 0; i <= nx_; ++i)
        points_[j * kTilePosts + i] = surface_->post(level_, x0_ + i, y0_ + j, view_.height(i, j));
  }
  squares_.resize(kSquares * kSquares);
  build_heights();
  Lattice lattice;
  const std::uint32_t across = (nx_ + kSquareCells - 1) / kSquareCells,
                      down = (ny_ + kSquareCells - 1) / kSquareCells;
  const double reach = 0.5 * (double(view_.record->high) - double(view_.record->low));
  for (std::uint32_t j = 0; j <= down; ++j)
    for (std::uint32_t i = 0; i <= across; ++i) {
      const auto at = [&](double h) {
        return surface_->post(level_, x0_ + std::min(i * kSquareCells, nx_),
                              y0_ + std::min(j * kSquareCells, ny_), h);
      };
      constexpr double kApart = 4096;  // metres: verticals are right to 1e-13
      const Vec3 p = at(middle_);
      lattice.points[j][i] = axes_ * (p - centre_);
      lattice.verticals[j][i] = axes_ * ((at(middle_ + kApart) - p) / kApart);
      const Vec3& q = lattice.points[j][i];
      radius_ = std::max(radius_, std::sqrt(glm::dot(q, q)) + reach);
    }
  const double posts = std::ldexp(double(kSquareCells), static_cast<int>(level_));
  radius_ = 1.0001 * (radius_ + surface_->bend(posts, posts, double(view_.record->high)));
  nodes_.resize(first_of(kSquareDepth));
  for (Boxes& boxes : nodes_)
    for (std::size_t k = 0; k < 3; ++k) {
      boxes.low[k].fill(kFar);
      boxes.high[k].fill(-kFar);
    }
  for (std::uint32_t y = 0; y < down; ++y)
    for (std::uint32_t x = 0; x < across; ++x) {
      const AxisBox box = build_square(lattice, x, y);
      if (box.empty()) continue;
      const std::uint32_t code = spread(x) | spread(y) << 1;
      Boxes& boxes = nodes_[first_of(kSquareDepth - 1) + (code >> 2)];
      for (std::size_t k = 0; k < 3; ++k) {
        boxes.low[k][code & 3] = static_cast<float>(box.low[static_cast<int>(k)]);
        boxes.high[k][code & 3] = static_cast<float>(box.high[static_cast<int>(k)]);
      }
    }
  for (std::uint32_t n = static_cast<std::uint32_t>(nodes_.size()) - 1; n > 0; --n) {
    // children of node n are from 4n + 1 on, by the sum of the depths above
    const std::uint32_t parent = (n - 1) / 4, lane = (n - 1) % 4;
    for (std::size_t k = 0; k < 3; ++k) {
      nodes_[parent].low[k][lane] = *std::ranges::min_element(nodes_[n].low[k]);
      nodes_[parent].high[k][lane] = *std::ranges::max_element(nodes_[n].high[k]);
    }
  }
}

}  // namespace panwright::terrain::internal
