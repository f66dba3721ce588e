#include "terrain/internal/chart_surface.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "terrain/internal/tile_tree.h"
#include "terrain/internal/tree_cache.h"

namespace panwright::terrain::internal {

namespace {

// Distance at which a ray meets a triangle, from either side, its edges included.
std::optional<double> meet(const TerrainRay& ray, const std::array<Vec3, 3>& corners) {
  const Vec3 a = corners[1] - corners[0], b = corners[2] - corners[0];
  const Vec3 p = glm::cross(ray.direction, b);
  const double det = glm::dot(a, p);
  if (det == 0) return {};
  const Vec3 from = ray.origin - corners[0];
  const double u = glm::dot(from, p) / det;
  const Vec3 q = glm::cross(from, a);
  const double v = glm::dot(ray.direction, q) / det;
  // note: rays along an edge meet one of its triangles at least
  constexpr double kEdge = 1e-11;
  if (u < -kEdge || v < -kEdge || u + v > 1 + kEdge) return {};
  return glm::dot(b, q) / det;
}

Vec3 normal_of(const std::array<Vec3, 3>& corners) {
  return glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
}

std::atomic<std::uint64_t> surfaces{0};

}  // namespace

CellPosts& ChartSurface::slot(std::uint32_t column, std::uint32_t row) {
  constexpr std::uint32_t kColumns = 32, kRows = 16;
  static thread_local std::vector<CellPosts> cells(std::size_t{kColumns} * kRows);
  return cells[row % kRows * kColumns + column % kColumns];
}

ChartSurface::ChartSurface(const Tiles& tiles, std::uint32_t chart, std::size_t fine_tiles)
    : tiles_(&tiles),
      chart_(chart),
      number_(++surfaces),
      record_(&tiles.charts()[chart]),
      map_(tiles.map(chart)) {
  for (std::uint32_t k = 0; k < record_->levels; ++k) first_.push_back(tiles.index(chart, k, 0, 0));
  is_sphere_ = record_->radius == record_->polar_radius;
  is_large_ =
      std::size_t{level_side(record_->width, 0).tiles} * level_side(record_->height, 0).tiles >
      fine_tiles;
  if (map_.kind == Map::Kind::polar) {
    const auto [s, c] = det::sincos(map_.center_longitude * kDegree);
    centre_turn_ = {s, c};
    scale_ = map_.radius * (1 + det::sin(std::fabs(map_.standard_latitude) * kDegree));
  }
  if (map_.kind == Map::Kind::cylindrical) {
    scale_ = 1 / det::cos(map_.standard_latitude * kDegree);
    const double along = map_.radius * det::cos(map_.standard_latitude * kDegree);
    columns_.reserve(record_->width);
    rows_.reserve(record_->height);
    for (std::uint32_t i = 0; i < record_->width; ++i) {
      const auto [s, c] =
          det::sincos(map_.center_longitude * kDegree + (record_->left + i * record_->dx) / along);
      columns_.push_back({s, c});
    }
    // the closing column of a whole turn is the first
    if (record_->flags & kChartWraps) columns_.back() = columns_.front();
    for (std::uint32_t j = 0; j < record_->height; ++j) {
      const auto [s, c] = det::sincos((record_->top - j * record_->dy) / map_.radius);
      rows_.push_back({s, c});
      if (!is_sphere_) row_radii_.push_back(radius({c, 0, s}));
    }
  }
  boxes_.resize(record_->tile_count);
  constexpr std::size_t kBatch = 256;
  parallel_for((boxes_.size() + kBatch - 1) / kBatch, [&](std::size_t batch) {
    const std::size_t end = std::min(boxes_.size(), (batch + 1) * kBatch);
    for (std::size_t t = batch * kBatch; t < end; ++t)
      boxes_[t] = box_of(record_->first_tile + static_cast<std::uint32_t>(t));
  });
}

Vec3 ChartSurface::vertical(PostIndex index) const {
  if (map_.kind == Map::Kind::cylindrical) {
    const Vec2 x = columns_[index.column], y = rows_[index.row];
    return {y.y * x.y, y.y * x.x, y.x};
  }
  if (is_sphere_) {
    // the sphere from its stereographic map, without angles
    const double a = (record_->left + index.column * record_->dx) / scale_;
    double b = (record_->top - index.row * record_->dy) / scale_;
    if (map_.north) b = -b;
    const double square = a * a + b * b, inverse = 1 / (1 + square);
    const double s = 2 * a * inverse, c = 2 * b * inverse, z = (1 - square) * inverse;
    return {c * centre_turn_.y - s * centre_turn_.x, s * centre_turn_.y + c * centre_turn_.x,
            map_.north ? z : -z};
  }
  const LatLon place = map_.at(index.column + 0.5, index.row + 0.5);
  const auto [sy, cy] = det::sincos(place.latitude * kDegree);
  const auto [sx, cx] = det::sincos(place.longitude * kDegree);
  return {cy * cx, cy * sx, sy};
}

double ChartSurface::radius(const Vec3& v) const {
  const double a = record_->radius, b = record_->polar_radius;
  if (a == b) return a;
  return a * b / std::sqrt(b * b * (v.x * v.x + v.y * v.y) + a * a * v.z * v.z);
}

Vec3 ChartSurface::post(PostIndex index, double height) const {
  if (is_plane())
    return {record_->left + index.column * record_->dx, record_->top - index.row * record_->dy,
            height};
  const Vec3 v = vertical(index);
  const double r = !row_radii_.empty() ? row_radii_[index.row] : radius(v);
  return (r + height) * v;
}

// A bilinear interpolation errs by (u² |p_uu| + v² |p_vv|) / 8, and a body's radius bounds the
// derivatives by angles (of a stereographic map by its unit: 4).
double ChartSurface::bend(double posts_across, double posts_down, double high) const {
  if (is_plane()) return 0;
  const double r = std::max(record_->radius, record_->polar_radius);
  const double flat = std::fabs(record_->radius - record_->polar_radius) / r;
  // one more for their rounded numbers
  const double u = (posts_across + 1) * record_->dx, v = (posts_down + 1) * record_->dy;
  const bool polar = map_.kind == Map::Kind::polar;
  const double along = polar ? scale_ : map_.radius * det::cos(map_.standard_latitude * kDegree);
  const double down = polar ? scale_ : map_.radius;
  return (r + std::max(high, 0.0)) * (polar ? 4 : 1) * (1 + 10 * flat) / 8 *
         (u * u / (along * along) + v * v / (down * down));
}

// The box about points of the tile at its least and largest height, and what the ground bends
// between these.
ChartSurface::TileBox ChartSurface::box_of(std::uint32_t tile) const {
  const TileRecord& record = tiles_->records()[tile];
  const std::uint64_t x0 = std::uint64_t{record.column} * kTileCells << record.level,
                      y0 = std::uint64_t{record.row} * kTileCells << record.level,
                      side = std::uint64_t{kTileCells} << record.level;
  const std::uint64_t x1 = std::min<std::uint64_t>(x0 + side, record_->width - 1),
                      y1 = std::min<std::uint64_t>(y0 + side, record_->height - 1);
  const std::uint64_t parts = is_plane() ? 1 : record.level < 3 ? 4 : 8;
  const auto index = [&](std::uint64_t i, std::uint64_t j) {
    return PostIndex{static_cast<std::uint32_t>(x0 + (x1 - x0) * i / parts),
                     static_cast<std::uint32_t>(y0 + (y1 - y0) * j / parts)};
  };
  const double low = record.low, high = record.high;
  TileBox box;
  const Vec3 middle = post(index(parts / 2, parts / 2), 0.5 * (low + high));
  const Vec3 up = is_plane() ? Vec3(0, 0, 1) : middle / std::sqrt(glm::dot(middle, middle));
  Vec3 across = post(index(parts, parts / 2), 0) - post(index(parts / 2, parts / 2), 0);
  across -= glm::dot(across, up) * up;
  // of a row at a pole there is no direction
  if (!(glm::dot(across, across) > 0)) {
    across = std::fabs(up.x) < 0.7 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    across -= glm::dot(across, up) * up;
  }
  across = glm::normalize(across);
  box.axes = glm::transpose(Mat3(across, glm::cross(up, across), up));
  Vec3 from(std::numeric_limits<double>::infinity()), to = -from;
  for (std::uint64_t j = 0; j <= parts; ++j)
    for (std::uint64_t i = 0; i <= parts; ++i)
      for (const double h : {low, high}) {
        const Vec3 p = box.axes * (post(index(i, j), h) - middle);
        from = glm::min(from, p);
        to = glm::max(to, p);
      }
  // posts between those above
  const double slack =
      1e-6 + bend(double(x1 - x0) / double(parts), double(y1 - y0) / double(parts), high);
  box.centre = middle + glm::transpose(box.axes) * (0.5 * (from + to));
  box.half = 0.5 * (to - from) + slack;
  box.radius = std::sqrt(glm::dot(box.half, box.half));
  return box;
}

bool ChartSurface::meets(const TileBox& box, const TerrainRay& ray, double within,
                         double& entry) const {
  const Vec3 to = box.centre - ray.origin;
  const double along = glm::dot(to, ray.direction);
  const Vec3 beside = along * ray.direction - to;
  // the box's sphere with all that is near it: that of the wider box is larger
  const double radius = box.radius + 1.8 * within;
  const double left = radius * radius - glm::dot(beside, beside);
  if (left < 0) return false;
  const double half = std::sqrt(left);
  double in = std::max(ray.least - along, -half), out = std::min(ray.most - along, half);
  if (in > out) return false;
  // of planes the axes are those of space
  const bool turned = !is_plane();
  const Vec3 from = turned ? box.axes * beside : beside,
             direction = turned ? box.axes * ray.direction : ray.direction;
  for (int k = 0; k < 3; ++k) {
    // finite, so that nothing becomes NaN
    const double inverse = 1 / (std::fabs(direction[k]) > 1e-100 ? direction[k] : 1e-100);
    const double side = box.half[k] + within;
    const double a = (-side - from[k]) * inverse, b = (side - from[k]) * inverse;
    in = std::max(in, std::min(a, b));
    out = std::min(out, std::max(a, b));
  }
  entry = along + in;
  return in <= out;
}

std::optional<TileView> ChartSurface::tile_of(std::uint32_t column, std::uint32_t row) const {
  const std::uint32_t across = level_side(record_->width, 0).tiles;
  return tiles_->view(first_[0] + row * across + column);
}

std::optional<TriangleHit> ChartSurface::triangle_on(const TileView& view, std::uint32_t column,
                                                     std::uint32_t row, std::uint32_t which,
                                                     const TerrainRay& ray) const {
  const std::uint32_t tx = view.record->column * kTileCells, ty = view.record->row * kTileCells;
  TriangleHit hit;
  hit.column = column;
  hit.row = row;
  hit.triangle = which;
  const std::uint32_t places[3][2] = {
      {column, row},
      {column + 1, row + 1},
      {which == 0 ? column + 1 : column, row + (which == 0 ? 0 : 1)}};
  // counter-clockwise from outside: rows run to the south
  const int order[2][3] = {{0, 1, 2}, {0, 2, 1}};
  for (int k = 0; k < 3; ++k) {
    const auto* place = places[order[which][k]];
    const double h = view.height(place[0] - tx, place[1] - ty);
    if (std::isnan(h)) return {};
    hit.corners[static_cast<std::size_t>(k)] = post({place[0], place[1]}, h);
  }
  const auto distance = meet(ray, hit.corners);
  if (!distance) return {};
  hit.distance = *distance;
  return hit;
}

// A tree of levels, from the nearest of the children of a tile.
void ChartSurface::cast(GroundWalk& walk, std::span<const std::uint8_t> refined,
                        TreeCache& trees) const {
  struct Entry {
    double at;
    std::uint32_t level, column, row;
  };
  std::array<Entry, 3 * 32 + 4> stack;
  std::size_t count = 0;
  double entry = 0;
  const auto meet = [&](std::uint32_t tile) {
    const TerrainRay& ray = walk.ray;
    return meets(boxes_[tile - record_->first_tile],
                 {ray.origin, ray.direction, ray.least, walk.most}, 0, entry);
  };
  if (!meet(first_.back())) return;
  stack[count++] = {entry, record_->levels - 1, 0, 0};
  while (count > 0) {
    const Entry here = stack[--count];
    if (here.at > walk.most) continue;
    const std::uint32_t tile =
        first_[here.level] + here.row * level_side(record_->width, here.level).tiles + here.column;
    if (here.level == 0 || (!refined.empty() && refined[tile] == 0)) {
      trees.of(tile, *this).cast(walk);
      if (walk.any && walk.best) return;
      continue;
    }
    const std::uint32_t level = here.level - 1;
    const std::uint32_t across = level_side(record_->width, level).tiles,
                        down = level_side(record_->height, level).tiles;
    const std::size_t begin = count;
    for (std::uint32_t r = 2 * here.row; r < std::min(2 * here.row + 2, down); ++r)
      for (std::uint32_t c = 2 * here.column; c < std::min(2 * here.column + 2, across); ++c) {
        const std::uint32_t child = first_[level] + r * across + c;
        if (!meet(child)) continue;
        // the nearest last
        std::size_t at = count++;
        for (; at > begin && stack[at - 1].at < entry; --at) stack[at] = stack[at - 1];
        stack[at] = {entry, level, c, r};
      }
  }
}

void ChartSurface::approach(GroundApproach& walk, TreeCache& trees) const {
  struct Entry {
    double squared;
    std::uint32_t level, column, row;
  };
  const auto square_to = [&](std::uint32_t tile) {
    const double distance = distance_to(tile, walk.point);
    return distance * distance;
  };
  std::array<Entry, 3 * 32 + 4> stack;
  std::size_t count = 0;
  stack[count++] = {square_to(first_.back()), record_->levels - 1, 0, 0};
  while (count > 0) {
    const Entry here = stack[--count];
    if (here.squared > walk.squared) continue;
    if (here.level == 0) {
      const std::uint32_t across = level_side(record_->width, 0).tiles;
      trees.of(first_[0] + here.row * across + here.column, *this).approach(walk);
      continue;
    }
    const std::uint32_t level = here.level - 1;
    const std::uint32_t across = level_side(record_->width, level).tiles,
                        down = level_side(record_->height, level).tiles;
    const std::size_t begin = count;
    for (std::uint32_t r = 2 * here.row; r < std::min(2 * here.row + 2, down); ++r)
      for (std::uint32_t c = 2 * here.column; c < std::min(2 * here.column + 2, across); ++c) {
        const double squared = square_to(first_[level] + r * across + c);
        // the nearest last
        std::size_t at = count++;
        for (; at > begin && stack[at - 1].squared < squared; --at) stack[at] = stack[at - 1];
        stack[at] = {squared, level, c, r};
      }
  }
}

double ChartSurface::distance_to(std::uint32_t tile, const Vec3& observer) const {
  const TileBox& box = boxes_[tile - record_->first_tile];
  const Vec3 p = glm::abs(box.axes * (observer - box.centre)) - box.half;
  const Vec3 outside = glm::max(p, Vec3(0));
  return std::sqrt(glm::dot(outside, outside));
}

double ChartSurface::spacing(std::uint32_t tile) const {
  const TileRecord& record = tiles_->records()[tile];
  const double posts = std::ldexp(1.0, static_cast<int>(record.level));
  // nowhere larger: cylindrical maps shrink to the poles, polar ones from them
  double stretch = 1;
  if (map_.kind == Map::Kind::cylindrical) stretch = 1 / det::cos(map_.standard_latitude * kDegree);
  if (map_.kind == Map::Kind::polar) stretch = 2 * map_.radius / scale_;
  if (!is_plane()) stretch *= 1 + std::max(double(record.high), 0.0) / map_.radius;
  return posts * stretch * std::sqrt(record_->dx * record_->dx + record_->dy * record_->dy);
}

class ChartSurface::LevelPosts {
 public:
  LevelPosts(const ChartSurface& surface, std::uint32_t level)
      : surface_(surface),
        level_(level),
        across_(level_side(surface.record_->width, level)),
        down_(level_side(surface.record_->height, level)),
        wraps_((surface.record_->flags & kChartWraps) != 0) {}

  Vec3 at(std::int64_t column, std::int64_t row) {
    const auto columns = static_cast<std::int64_t>(across_.posts),
               rows = static_cast<std::int64_t>(down_.posts);
    // the last column is the first
    if (wraps_ && column < 0) column += columns - 1;
    if (wraps_ && column >= columns) column -= columns - 1;
    if (column < 0 || row < 0 || column >= columns || row >= rows) return kMissing;
    const auto x = static_cast<std::uint32_t>(column), y = static_cast<std::uint32_t>(row);
    if (!holds(x, y)) {
      const std::uint32_t tx = std::min(x / kTileCells, across_.tiles - 1),
                          ty = std::min(y / kTileCells, down_.tiles - 1);
      view_ = surface_.tiles_->view(surface_.first_[level_] + ty * across_.tiles + tx);
      x0_ = tx * kTileCells;
      y0_ = ty * kTileCells;
      known_ = true;
    }
    if (!view_) return kMissing;
    return surface_.post(level_, x, y, view_->height(x - x0_, y - y0_));
  }

 private:
  static constexpr Vec3 kMissing{std::numeric_limits<double>::quiet_NaN()};
  bool holds(std::uint32_t x, std::uint32_t y) const {
    return known_ && x >= x0_ && y >= y0_ && x - x0_ < kTilePosts && y - y0_ < kTilePosts;
  }

  const ChartSurface& surface_;
  std::uint32_t level_;
  LevelSide across_, down_;
  bool wraps_, known_ = false;
  std::optional<TileView> view_;
  std::uint32_t x0_ = 0, y0_ = 0;
};

// Sets the posts of a cell, and those beside them: corners of the square of four are not needed.
void ChartSurface::set_posts(const GroundPoint& point, Vec3 (&grid)[4][4]) const {
  const auto is_corner = [](int i, int j) { return (i == 0 || i == 3) && (j == 0 || j == 3); };
  const std::uint32_t left = point.column % kTileCells, top = point.row % kTileCells;
  const LevelSide across = level_side(record_->width, point.level),
                  down = level_side(record_->height, point.level);
  if (left > 0 && top > 0 && left + 2 < kTilePosts && top + 2 < kTilePosts &&
      point.column + 2 < across.posts && point.row + 2 < down.posts) {
    if (const auto view = tiles_->view(first_[point.level] + point.row / kTileCells * across.tiles +
                                       point.column / kTileCells)) {
      const auto height = [&](std::uint32_t i, std::uint32_t j) {
        return height_of(*view, left - 1 + i, top - 1 + j);
      };
      posts(point.level, point.column - 1, point.row - 1, 4, 4, height, &grid[0][0]);
      return;
    }
  }
  LevelPosts beside(*this, point.level);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      if (!is_corner(i, j))
        grid[j][i] = beside.at(std::int64_t{point.column} + i - 1, std::int64_t{point.row} + j - 1);
}

// Of posts by those beside them; none at a pole, or beside voids.
void ChartSurface::set_normals(const GroundPoint& point, CellPosts& cell) const {
  Vec3 grid[4][4];
  set_posts(point, grid);
  const auto apart = [](const Vec3& before, const Vec3& here, const Vec3& after) {
    return (std::isnan(after.x) ? here : after) - (std::isnan(before.x) ? here : before);
  };
  cell.surface = number_;
  cell.level = point.level;
  cell.column = point.column;
  cell.row = point.row;
  cell.state = CellPosts::Normals::known;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t i = k % 2, j = k / 2;
    const Vec3& here = cell.posts[k] = grid[j + 1][i + 1];
    const Vec3 right = apart(grid[j + 1][i], here, grid[j + 1][i + 2]),
               below = apart(grid[j][i + 1], here, grid[j + 2][i + 1]);
    const Vec3 normal = glm::cross(below, right);
    const double length = std::sqrt(glm::dot(normal, normal));
    if (!(length > 0)) cell.state = CellPosts::Normals::none;
    cell.normals[k] = normal / length;
    // posts on the border of a damaged tile are missing here, not in the cell's own tile
    if (std::isnan(here.z)) cell.surface = 0;
  }
}

SmoothGround ChartSurface::smooth(const GroundPoint& point) const {
  CellPosts& cell = slot(point.column, point.row);
  if (cell.state == CellPosts::Normals::unknown || cell.surface != number_ ||
      cell.column != point.column || cell.row != point.row || cell.level != point.level)
    set_normals(point, cell);
  if (cell.state == CellPosts::Normals::none) return {point.normal, 0};
  const Vec3 &a = cell.posts[0], &d = cell.posts[3];
  const Vec3& side = point.triangle == 0 ? cell.posts[1] : cell.posts[2];
  // shares of the point along the cell, by areas in its triangle
  const Vec3 along = side - a, across = d - a, off = point.position - a;
  const double ss = glm::dot(along, along), sd = glm::dot(along, across),
               dd = glm::dot(across, across), os = glm::dot(off, along), od = glm::dot(off, across),
               whole = ss * dd - sd * sd;
  const double first = std::clamp((dd * os - sd * od) / whole, 0.0, 1.0),
               second = std::clamp((ss * od - sd * os) / whole, 0.0, 1.0);
  const double u = second + (point.triangle == 0 ? first : 0),
               v = second + (point.triangle == 0 ? 0 : first);
  const double weights[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
  Vec3 sum(0), up(0);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3& unit = cell.normals[k];
    sum += weights[k] * unit;
    up += weights[k] * glm::dot(cell.posts[k] - point.position, unit) * unit;
  }
  const double length = std::sqrt(glm::dot(sum, sum));
  if (!(length > 0)) return {point.normal, 0};
  const Vec3 normal = sum / length;
  const double rise = glm::dot(up, normal);
  return {normal, rise > 0 ? rise : 0};
}

LatLon ChartSurface::place_of(const Vec3& p) const {
  if (is_plane()) return {p.y, p.x};
  return {det::atan2(p.z, std::sqrt(p.x * p.x + p.y * p.y)) / kDegree,
          det::atan2(p.y, p.x) / kDegree};
}

GroundPoint ChartSurface::point_of(const TriangleHit& hit, const Vec3& position, bool slope) const {
  GroundPoint out;
  out.position = position;
  out.normal = normal_of(hit.corners);
  out.chart = chart_;
  out.column = hit.column;
  out.row = hit.row;
  out.level = hit.level;
  out.triangle = hit.triangle;
  const double distance = std::sqrt(glm::dot(position, position));
  const Vec3 up = is_plane() ? Vec3(0, 0, 1) : position / distance;
  out.height = is_plane() ? position.z : distance - radius(up);
  if (slope)
    out.slope =
        det::atan2(std::sqrt(glm::dot(glm::cross(out.normal, up), glm::cross(out.normal, up))),
                   glm::dot(out.normal, up));
  return out;
}

GroundPoint ChartSurface::at(const LatLon& place) const {
  const std::uint32_t w = record_->width, h = record_->height;
  if (w < 2 || h < 2) return {};
  Vec2 post;
  TerrainRay ray{};
  if (is_plane()) {
    post = {(place.longitude - record_->left) / record_->dx,
            (record_->top - place.latitude) / record_->dy};
    ray = {{place.longitude, place.latitude, 0}, {0, 0, 1}, 0, 0};
  } else {
    // note: the map's turn is that nearest to its middle, the closing column left out
    post = map_.pixel(place, w - (record_->flags & kChartWraps ? 1 : 0)) - Vec2(0.5);
    if (record_->flags & kChartWraps && post.x < 0) post.x += w - 1;
    const auto [sy, cy] = det::sincos(place.latitude * kDegree);
    const auto [sx, cx] = det::sincos(place.longitude * kDegree);
    ray = {{0, 0, 0}, {cy * cx, cy * sx, sy}, 0, 0};
  }
  constexpr double kOutside = 1e-6;  // posts
  if (!(post.x >= -kOutside && post.y >= -kOutside && post.x <= w - 1 + kOutside &&
        post.y <= h - 1 + kOutside))
    return {};
  const auto x = static_cast<std::uint32_t>(std::clamp(post.x, 0.0, w - 2.0)),
             y = static_cast<std::uint32_t>(std::clamp(post.y, 0.0, h - 2.0));
  const auto test = [&](std::uint32_t cx, std::uint32_t cy,
                        std::uint32_t which) -> std::optional<GroundPoint> {
    const auto view = tile_of(cx / kTileCells, cy / kTileCells);
    if (!view) return {};
    const auto hit = triangle_on(*view, cx, cy, which, ray);
    if (!hit) return {};
    return point_of(*hit, ray.origin + hit->distance * ray.direction, true);
  };
  const std::uint32_t first = post.x - x >= post.y - y ? 0 : 1;
  if (const auto point = test(x, y, first)) return *point;
  if (const auto point = test(x, y, 1 - first)) return *point;
  // edges are straight in space, not on the map: the place may be in a neighbour
  for (std::uint32_t cy = y > 0 ? y - 1 : 0; cy <= std::min(y + 1, h - 2); ++cy)
    for (std::uint32_t cx = x > 0 ? x - 1 : 0; cx <= std::min(x + 1, w - 2); ++cx)
      for (std::uint32_t which = 0; which < 2; ++which)
        if (cx != x || cy != y)
          if (const auto point = test(cx, cy, which)) return *point;
  return {};
}

}  // namespace panwright::terrain::internal
