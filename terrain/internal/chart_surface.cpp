#include "terrain/internal/chart_surface.h"

#include <algorithm>
#include <cmath>

namespace panwright::terrain::internal {

namespace {

constexpr std::uint32_t kBlockCells = kTileCells / kMipBlocks;

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

}  // namespace

struct ChartSurface::Walk {
  const TerrainRay& ray;
  bool any;
  const AcceptHit& accept;
  double most;
  std::optional<TriangleHit> best;
  bool done() const { return any && best; }
};

ChartSurface::ChartSurface(const Tiles& tiles, std::uint32_t chart)
    : tiles_(&tiles), chart_(chart), record_(&tiles.charts()[chart]), map_(tiles.map(chart)) {
  for (std::uint32_t k = 0; k < record_->levels; ++k) first_.push_back(tiles.index(chart, k, 0, 0));
  if (!is_plane()) {
    largest_radius_ = std::max(record_->radius, record_->polar_radius);
    least_radius_ = std::min(record_->radius, record_->polar_radius);
  }
  if (map_.kind != Map::Kind::cylindrical) return;
  const double along = map_.radius * det::cos(map_.standard_latitude * kDegree);
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
  }
}

Vec3 ChartSurface::vertical(double column, double row) const {
  if (map_.kind == Map::Kind::cylindrical && column == std::floor(column) &&
      row == std::floor(row)) {
    const Vec2 x = columns_[static_cast<std::size_t>(column)],
               y = rows_[static_cast<std::size_t>(row)];
    return {y.y * x.y, y.y * x.x, y.x};
  }
  const LatLon place = map_.at(column + 0.5, row + 0.5);
  const auto [sy, cy] = det::sincos(place.latitude * kDegree);
  const auto [sx, cx] = det::sincos(place.longitude * kDegree);
  return {cy * cx, cy * sx, sy};
}

double ChartSurface::radius(const Vec3& v) const {
  const double a = record_->radius, b = record_->polar_radius;
  if (a == b) return a;
  return a * b / std::sqrt(b * b * (v.x * v.x + v.y * v.y) + a * a * v.z * v.z);
}

Vec3 ChartSurface::point(double column, double row, double height) const {
  if (is_plane())
    return {record_->left + column * record_->dx, record_->top - row * record_->dy, height};
  const Vec3 v = vertical(column, row);
  return (radius(v) + height) * v;
}

// Most metres on the sphere from the middle of a cell to its corners, twice.
double ChartSurface::cell_reach(std::uint32_t y0, std::uint32_t y1) const {
  if (is_plane()) return std::sqrt(record_->dx * record_->dx + record_->dy * record_->dy);
  if (map_.kind == Map::Kind::cylindrical) {
    const double top = record_->top - y0 * record_->dy, bottom = record_->top - y1 * record_->dy;
    const double widest = top * bottom <= 0 ? 0 : std::min(std::fabs(top), std::fabs(bottom));
    const double x = record_->dx * det::cos(std::min(widest / map_.radius, kPi / 2)) /
                     det::cos(map_.standard_latitude * kDegree);
    return std::sqrt(x * x + record_->dy * record_->dy);
  }
  // the scale of polar maps is least at the pole
  const double f = (1 + det::sin(std::fabs(map_.standard_latitude) * kDegree)) / 2;
  return std::sqrt(record_->dx * record_->dx + record_->dy * record_->dy) / f;
}

// Whether a ray may meet the ground of a node before `most`; sets its entry.
bool ChartSurface::meets(const TerrainRay& ray, double most, Node& node) const {
  const double middle = 0.5 * (node.low + node.high);
  const std::uint32_t cx = node.x + node.nx / 2, cy = node.y + node.ny / 2;
  const Vec3 centre = point(cx, cy, middle);
  // from the post nearest to the middle to the furthest corner
  const double cells = std::max(node.nx, node.ny) / 2 + 1;
  const double stretch = is_plane() ? 1 : 1 + std::max(node.high, 0.0) / least_radius_;
  // of an ellipsoid the radius changes within the node
  const double reach = cell_reach(node.y, node.y + node.ny) * cells * stretch +
                       0.5 * (node.high - node.low) + (largest_radius_ - least_radius_);
  const Vec3 to = centre - ray.origin;
  const double along = glm::dot(to, ray.direction);
  const double aside = glm::dot(to, to) - along * along;
  const double half2 = reach * reach - aside;
  if (half2 < 0) return false;
  const double half = std::sqrt(half2);
  const double from = std::max(ray.least, along - half), until = std::min(most, along + half);
  if (from > until) return false;
  node.entry = from;
  // the ray's height over the interval: convex on a sphere, so that its least is within or at an
  // end
  const auto height = [&](double t, double r) {
    const Vec3 p = ray.origin + t * ray.direction;
    return is_plane() ? p.z : std::sqrt(glm::dot(p, p)) - r;
  };
  constexpr double kSlack = 1e-6;  // metres, of rounding at the Moon's radius
  const double turn = std::clamp(-glm::dot(ray.origin, ray.direction), from, until);
  const double least =
      is_plane() ? std::min(height(from, 0), height(until, 0)) : height(turn, largest_radius_);
  if (least > node.high + kSlack) return false;
  // facets sag below their corners
  const double angle = is_plane() ? 0 : reach / least_radius_;
  const double low =
      node.low - (angle > 0 ? (largest_radius_ + node.high) * std::min(1.0, angle * angle) : 0);
  return std::max(height(from, least_radius_), height(until, least_radius_)) >= low - kSlack;
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
    hit.corners[static_cast<std::size_t>(k)] = point(place[0], place[1], h);
  }
  const auto distance = meet(ray, hit.corners);
  if (!distance) return {};
  hit.distance = *distance;
  return hit;
}

void ChartSurface::visit_cells(Walk& walk, const TileView& view, const Node& node) const {
  for (std::uint32_t y = node.y; y < node.y + node.ny; ++y)
    for (std::uint32_t x = node.x; x < node.x + node.nx; ++x) {
      Node cell{node.tile, x, y, 1, 1, node.low, node.high, 0};
      if (!meets(walk.ray, walk.most, cell)) continue;
      for (std::uint32_t which = 0; which < 2; ++which) {
        const auto hit = triangle_on(view, x, y, which, walk.ray);
        if (!hit || hit->distance < walk.ray.least || hit->distance >= walk.most ||
            !walk.accept(*hit))
          continue;
        walk.best = hit;
        walk.most = hit->distance;
        if (walk.any) return;
      }
    }
}

// A square of blocks within a tile, from the nearest of its quarters.
void ChartSurface::visit_block(Walk& walk, const TileView& view, const Node& node) const {
  if (node.nx <= kBlockCells && node.ny <= kBlockCells) return visit_cells(walk, view, node);
  const std::uint32_t tx = view.record->column * kTileCells, ty = view.record->row * kTileCells;
  std::uint32_t half = kBlockCells;
  while (2 * half < std::max(node.nx, node.ny)) half *= 2;
  std::array<Node, 4> parts;
  std::size_t count = 0;
  for (std::uint32_t j = 0; j < node.ny; j += half)
    for (std::uint32_t i = 0; i < node.nx; i += half) {
      Node part{node.tile,
                node.x + i,
                node.y + j,
                std::min(half, node.nx - i),
                std::min(half, node.ny - j),
                node.low,
                view.record->low,
                0};
      for (std::uint32_t b = (part.y - ty) / kBlockCells; b * kBlockCells < part.y - ty + part.ny;
           ++b)
        for (std::uint32_t a = (part.x - tx) / kBlockCells; a * kBlockCells < part.x - tx + part.nx;
             ++a)
          part.high = std::max(part.high, view.mip(a, b));
      if (meets(walk.ray, walk.most, part)) parts[count++] = part;
    }
  std::sort(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Node& a, const Node& b) { return a.entry < b.entry; });
  for (std::size_t k = 0; k < count && !walk.done(); ++k)
    if (parts[k].entry < walk.most) visit_block(walk, view, parts[k]);
}

void ChartSurface::visit_tile(Walk& walk, std::uint32_t level, std::uint32_t column,
                              std::uint32_t row) const {
  if (level == 0) {
    const std::uint32_t tile = first_[0] + row * level_side(record_->width, 0).tiles + column;
    const auto view = tiles_->view(tile);
    if (!view) return;
    const Node node{tile,
                    column * kTileCells,
                    row * kTileCells,
                    std::min(kTileCells, record_->width - 1 - column * kTileCells),
                    std::min(kTileCells, record_->height - 1 - row * kTileCells),
                    view->record->low,
                    view->record->high,
                    0};
    return visit_block(walk, *view, node);
  }
  const LevelSide across = level_side(record_->width, level - 1),
                  down = level_side(record_->height, level - 1);
  struct Child {
    Node node;
    std::uint32_t column, row;
  };
  std::array<Child, 4> children;
  std::size_t count = 0;
  const std::uint64_t side = std::uint64_t{kTileCells} << (level - 1);
  for (std::uint32_t r = 2 * row; r < std::min(2 * row + 2, down.tiles); ++r)
    for (std::uint32_t c = 2 * column; c < std::min(2 * column + 2, across.tiles); ++c) {
      const TileRecord& tile = tiles_->records()[first_[level - 1] + r * across.tiles + c];
      const auto x = static_cast<std::uint32_t>(c * side), y = static_cast<std::uint32_t>(r * side);
      Node node{0,
                x,
                y,
                static_cast<std::uint32_t>(std::min<std::uint64_t>(side, record_->width - 1 - x)),
                static_cast<std::uint32_t>(std::min<std::uint64_t>(side, record_->height - 1 - y)),
                tile.low,
                tile.high,
                0};
      if (meets(walk.ray, walk.most, node)) children[count++] = {node, c, r};
    }
  std::sort(children.begin(), children.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Child& a, const Child& b) { return a.node.entry < b.node.entry; });
  for (std::size_t k = 0; k < count && !walk.done(); ++k)
    if (children[k].node.entry < walk.most)
      visit_tile(walk, level - 1, children[k].column, children[k].row);
}

std::optional<TriangleHit> ChartSurface::cast(const TerrainRay& ray, bool any,
                                              const AcceptHit& accept) const {
  Walk walk{ray, any, accept, ray.most, {}};
  visit_tile(walk, record_->levels - 1, 0, 0);
  return walk.best;
}

LatLon ChartSurface::place_of(const Vec3& p) const {
  if (is_plane()) return {p.y, p.x};
  return {det::atan2(p.z, std::sqrt(p.x * p.x + p.y * p.y)) / kDegree,
          det::atan2(p.y, p.x) / kDegree};
}

GroundPoint ChartSurface::point_of(const TriangleHit& hit, const Vec3& position) const {
  GroundPoint out;
  out.position = position;
  out.normal = normal_of(hit.corners);
  out.chart = chart_;
  out.column = hit.column;
  out.row = hit.row;
  out.triangle = hit.triangle;
  const double distance = std::sqrt(glm::dot(position, position));
  const Vec3 up = is_plane() ? Vec3(0, 0, 1) : position / distance;
  out.height = is_plane() ? position.z : distance - radius(up);
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
    return point_of(*hit, ray.origin + hit->distance * ray.direction);
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
