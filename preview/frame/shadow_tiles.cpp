#include "preview/frame/shadow_tiles.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace panwright::preview {
namespace {

// Tiles take a cell, a quarter of one, or a quarter of that, so many times.
constexpr unsigned kLevels = 5;
constexpr unsigned kLeastSide = 32;                            // texels
constexpr std::size_t kUnits = std::size_t{1} << 2 * kLevels;  // of a cell

// Float32 places a triangle to 2^-24 of its size, which comes to 1/16 of a texel so wide.
constexpr double kLeastTexel = 0x1p-20;

// the border that no receiver lies on, texels
constexpr double kBorder = 2;

// Depths are cut into so many steps: one of them at least stays free on each side. A surface as
// steep as 128 texels a texel does not leave the tile from one to the next.
constexpr double kDepthSteps = 16;
constexpr double kLeastDepth = 2048;  // texels

// The middle of a tile's depth lies near that of its receivers, so that rays to the Sun's disc move
// these little (sun_shear()): within half a step of this size, of the depth of its receivers and of
// kLeastDepth, whichever is larger.
constexpr double kMiddleStep = 1.0 / 16;

constexpr std::size_t kMostPieces = 1 << 15;

// Tiles keep their size and place while a camera moves a little: sizes come in steps of 2^(1/4),
// places in steps of 1/16 of a tile.
double stepped(double least) {
  constexpr double kSteps[] = {0.5, 0.59460355750136053, 0.70710678118654752, 0.84089641525371454};
  int exponent = 0;
  const double mantissa = std::frexp(least, &exponent);
  for (const double step : kSteps)
    if (mantissa <= step) return std::ldexp(step, exponent);
  return std::ldexp(1.0, exponent);
}

double aligned(double low, double step) { return std::floor(low / step) * step; }

// The tile in a map of so many texels, its corner at `corner`.
LightSpace light_space(const ShadowTiles& tiles, const ShadowTile& tile, const Vec2& corner,
                       const Vec2& size) {
  LightSpace frame;
  frame.extent = Vec3(size, tiles.depth) * tile.texel;
  frame.axes_from_model = tiles.light_from_model;
  const Vec3 scale = Vec3(2, 2, 1) / frame.extent;
  const Vec3 shift = Vec3(2.0 * corner / size - 1.0, 0) - scale * tile.low;
  const Vec3 stretch = Vec3(0.5, 0.5, 1) * frame.extent / max_component(frame.extent);
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row)
      frame.sun_from_model[column][row] = scale[row] * tiles.light_from_model[column][row];
    frame.sun_normal_from_model[column] = stretch * tiles.light_from_model[column];
  }
  frame.sun_from_model[3] = Vec4(shift, 1);
  return frame;
}

// Few cells are left over, and both sides stay short.
void set_tile_grid(ShadowTiles& tiles, std::size_t cells, std::size_t cells_a_row) {
  std::size_t columns = 1;
  while (columns * columns < cells) ++columns;
  columns = std::min(columns, cells_a_row);
  tiles.columns = static_cast<unsigned>(columns);
  tiles.rows = static_cast<unsigned>((cells + columns - 1) / columns);
}

Vec2 map_size(const ShadowTiles& tiles) {
  return Vec2(tiles.columns, tiles.rows) * static_cast<double>(tiles.side);
}

}  // namespace

LightSpace light_space_of_tile(const ShadowTiles& tiles, std::size_t tile) {
  return light_space(tiles, tiles.tiles[tile], Vec2(0), Vec2(tiles.tiles[tile].side));
}

LightSpace light_space_in_map(const ShadowTiles& tiles, std::size_t tile) {
  const ShadowTile& one = tiles.tiles[tile];
  return light_space(tiles, one, Vec2(one.x, one.y), map_size(tiles));
}

Vec4 inside_of_tile(const ShadowTiles& tiles, std::size_t tile) {
  const ShadowTile& one = tiles.tiles[tile];
  const Vec2 half = 0.5 * map_size(tiles);
  const Vec2 corner(one.x, one.y);
  const double border = 1 + one.margin;
  return {(corner + border) / half - 1.0, (corner + (one.side - border)) / half - 1.0};
}

void ShadowTileFinder::Fit::add(const ShownPart& part, const Piece& piece) {
  if (part.empty()) return;
  ShownPart padded = part;
  padded.light.widen(piece.pad);
  all.add(padded);
  across = std::max(across, piece.shape.across);
  deep = std::max(deep, piece.shape.deep);
}

double ShadowTileFinder::pixel_of(double depth) const {
  const world::Camera& camera = *frame_.camera;
  const double focal = std::max(camera.focal.x, camera.focal.y);
  return (camera.projection == world::Projection::perspective ? depth : 1.0) * image_pixel_ / focal;
}

// what single precision allows, metres
double ShadowTileFinder::finest_of(const Fit& fit) {
  const double deep = fit.all.light.high.z - fit.all.light.low.z;
  return stepped(std::max({deep * kLeastTexel, fit.across * kLeastTexel, 0x1p-900}));
}

// Border of a tile for rays to the Sun's disc from receivers of no depth, texels.
double ShadowTileFinder::margin_of(unsigned side) const {
  return std::min(sun_tangent_ * (0.5 * kMiddleStep * kLeastDepth), 0.25 * side);
}

// of a tile of so many texels, metres
double ShadowTileFinder::texel_of(const Fit& fit, unsigned side) const {
  const Vec3 extent = fit.all.light.extent();
  const double room = side - 2 * (kBorder + margin_of(side)) - side / 16;
  const double moved = sun_tangent_ * (1 + 2 * kMiddleStep) * extent.z;
  return std::max(finest_of(fit),
                  stepped(std::max((std::max(extent.x, extent.y) + moved) / room, 0x1p-900)));
}

// The smallest tile of enough texels a pixel; of none, the largest.
unsigned ShadowTileFinder::level_of(const Fit& fit) const {
  const double pixel = pixel_of(fit.all.view.low.z) / finer_;
  for (unsigned level = kLevels; level > 0; --level)
    if (side_ >> level >= kLeastSide + 3 * margin_of(side_) &&
        texel_of(fit, side_ >> level) <= pixel)
      return level;
  return 0;
}

void ShadowTileFinder::add_piece(const ViewCell& view, const ViewPiece& shape, const Piece& from) {
  const ShownPart shown = shown_part(frame_, view, shape);
  if (shown.empty()) return;
  Piece& piece = pieces_.emplace_back(from);
  piece.shape = shape;
  piece.shown = shown;
  measure(frame_, piece.shape);
}

// Where a box reaches from close by to far off, what is in it says more: first its runs of
// triangles, then these triangles.
void ShadowTileFinder::refine(const ViewCell& view, double most, std::span<const ShownItem> items) {
  if (frame_.camera->projection != world::Projection::perspective) return;
  for (int round = 0; round < 2; ++round) {
    coarse_.swap(pieces_);
    pieces_.clear();
    for (const Piece& piece : coarse_) {
      const bool vague = piece.shape.count == 8 && piece.shown.view.low.z < most &&
                         piece.shown.view.low.z < 0.5 * piece.shown.view.high.z;
      if (!vague || pieces_.size() > kMostPieces) {
        pieces_.push_back(piece);
        continue;
      }
      const ShownItem& item = items[piece.item];
      const Mat4& camera_from_mesh = item.box->camera_from_mesh;
      ViewPiece shape;
      if (piece.count == 0) {
        for (const MeshRun& run : runs_.find(item.owner, *item.model, item.mesh)) {
          Piece one = piece;
          one.first = run.first;
          one.count = run.count;
          shape.corners = corners(run.box.low, run.box.high);
          for (Vec3& corner : shape.corners) corner = Vec3(camera_from_mesh * Vec4(corner, 1));
          add_piece(view, shape, one);
        }
        continue;
      }
      const pan::MeshView mesh = item.model->mesh(item.mesh);
      shape.count = 3;
      for (std::size_t t = piece.first; t < std::size_t{piece.first} + piece.count; ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
          const pan::layout::Float3& p = mesh.positions[mesh.indices[3 * t + k]];
          shape.corners[k] = Vec3(camera_from_mesh * Vec4(p.x, p.y, p.z, 1));
        }
        add_piece(view, shape, piece);
      }
    }
  }
}

void ShadowTileFinder::halves(const Cell& cell, const Cut& cut, Cell* low, Cell* high, Fit& low_fit,
                              Fit& high_fit) const {
  ViewCell below = cell.view;
  ViewCell above = cell.view;
  if (cut.axis == 2) {
    below.far = cut.at;
    above.near = cut.at;
  } else {
    below.high[cut.axis] = cut.at;
    above.low[cut.axis] = cut.at;
  }
  const auto give = [&](const ViewCell& view, bool whole, const Part& part, Cell* to, Fit& fit) {
    const Piece& piece = pieces_[part.piece];
    const ShownPart shown = whole ? part.shown : shown_part(frame_, view, piece.shape);
    if (shown.empty()) return;
    fit.add(shown, piece);
    if (to) to->parts.push_back({part.piece, shown});
  };
  for (const Part& part : cell.parts) {
    const bool is_below = part.shown.view.high[cut.axis] <= cut.at;
    const bool is_above = part.shown.view.low[cut.axis] >= cut.at;
    if (!is_above) give(below, is_below, part, low, low_fit);
    if (!is_below) give(above, is_above, part, high, high_fit);
  }
  if (low) low->view = below;
  if (high) high->view = above;
}

// the middle of the widest range along an axis where nothing is
void ShadowTileFinder::find_gap(const Cell& cell, int axis, std::vector<Cut>& cuts) const {
  std::vector<std::pair<double, double>> ranges;
  for (const Part& part : cell.parts)
    ranges.emplace_back(part.shown.view.low[axis], part.shown.view.high[axis]);
  std::sort(ranges.begin(), ranges.end());
  double end = ranges.front().second;
  double widest = 0;
  double at = 0;
  for (const auto& [low, high] : ranges) {
    if (low - end > widest) {
      widest = low - end;
      at = end + 0.5 * widest;
    }
    end = std::max(end, high);
  }
  if (widest > 0) cuts.push_back({axis, at});
}

ShadowTileFinder::Cut ShadowTileFinder::best_cut(const Cell& cell) const {
  // Two sides count, so that a cut across the one that does not decide is a step too.
  const auto size_of = [&](const Fit& fit) {
    const Vec3 extent = fit.all.light.extent();
    return fit.all.empty() ? 0.0 : (extent.x + extent.y) / pixel_of(fit.all.view.low.z);
  };
  std::vector<Cut> cuts;
  const ShownPart& all = cell.fit.all;
  const bool perspective = frame_.camera->projection == world::Projection::perspective;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = all.view.low[axis];
    const double high = all.view.high[axis];
    if (!(high > low)) continue;
    cuts.push_back({axis, axis == 2 && perspective ? std::sqrt(low) * std::sqrt(high)
                                                   : low + 0.5 * (high - low)});
    find_gap(cell, axis, cuts);
  }
  Cut best;
  double least = 0.95 * size_of(cell.fit);
  for (const Cut& cut : cuts) {
    Fit low;
    Fit high;
    halves(cell, cut, nullptr, nullptr, low, high);
    const double size = std::max(size_of(low), size_of(high));
    if (!(size < least)) continue;
    least = size;
    best = cut;
  }
  return best;
}

std::size_t ShadowTileFinder::cells_of(std::span<const Cell> cells) const {
  std::size_t units = 0;
  for (const Cell& cell : cells)
    if (!cell.fit.all.empty()) units += kUnits >> 2 * level_of(cell.fit);
  return (units + kUnits - 1) / kUnits;
}

void ShadowTileFinder::place(std::span<const Cell> cells, const TileLimits& limits) {
  // room that is left makes penumbrae sharper, to an eighth of a pixel
  const std::size_t used = cells_of(cells);
  finer_ = sun_tangent_ > 0 ? 8 : 1;
  while (finer_ > 1 && cells_of(cells) > used) finer_ /= 2;
  set_tile_grid(tiles_, used, limits.cells_a_row);
  double worst = 0;
  tiles_.depth = kLeastDepth;
  for (const Cell& cell : cells) {
    const Fit& fit = cell.fit;
    if (fit.all.empty()) continue;
    ShadowTile tile;
    tile.side = side_ >> level_of(fit);
    tile.texel = texel_of(fit, tile.side);
    const double range = fit.all.light.high.z - fit.all.light.low.z;
    tile.margin = margin_of(tile.side) + sun_tangent_ * (0.5 + kMiddleStep) * range / tile.texel;
    const double step = tile.texel * (tile.side / 16);
    for (int axis = 0; axis < 2; ++axis)
      tile.low[axis] =
          aligned(fit.all.light.low[axis] - (kBorder + tile.margin) * tile.texel, step);
    const double middle_step =
        kMiddleStep * std::max(kLeastDepth * tile.texel, stepped(std::max(range, 0x1p-900)));
    tile.low.z = aligned(fit.all.light.low.z + 0.5 * (range + middle_step), middle_step);
    const double deep = std::max(range * (kDepthSteps / (kDepthSteps - 3)), fit.deep);
    while (tiles_.depth * tile.texel < deep) tiles_.depth *= 2;
    const double pixel = pixel_of(fit.all.view.low.z);
    if (tile.texel / pixel > worst) {
      worst = tile.texel / pixel;
      texel_ = tile.texel;
      pixel_ = pixel;
      finest_ = finest_of(fit);
    }
    tiles_.tiles.push_back(tile);
  }
  std::vector<ShadowTile>& list = tiles_.tiles;
  // the largest first, so that each begins where one of its size may
  std::stable_sort(list.begin(), list.end(),
                   [](const ShadowTile& a, const ShadowTile& b) { return a.side > b.side; });
  std::size_t unit = 0;
  for (ShadowTile& tile : list) {
    const std::size_t cell = unit / kUnits;
    tile.x = static_cast<unsigned>(cell % tiles_.columns) * side_;
    tile.y = static_cast<unsigned>(cell / tiles_.columns) * side_;
    unsigned level = 0;
    for (unsigned k = 1; k <= kLevels; ++k) {
      const std::size_t quarter = unit >> 2 * (kLevels - k) & 3;
      tile.x += quarter & 1 ? side_ >> k : 0;
      tile.y += quarter & 2 ? side_ >> k : 0;
      if (side_ >> k >= tile.side) level = k;
    }
    unit += kUnits >> 2 * level;
    tile.low.z -= 0.5 * tile.texel * tiles_.depth;
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const ShadowTile& a, const ShadowTile& b) { return a.texel < b.texel; });
}

// Cuts cells_ until all are fine enough or a limit is reached.
void ShadowTileFinder::cut_up(const TileLimits& limits) {
  while (cells_.size() < kMostShadowTiles) {
    auto worst = cells_.end();
    double most = kMostPixelsATexel;
    for (auto cell = cells_.begin(); cell != cells_.end(); ++cell) {
      const double coarse = coarseness(cell->fit);
      if (cell->final || !(coarse > most)) continue;
      most = coarse;
      worst = cell;
    }
    if (worst == cells_.end()) break;
    const Cut cut = best_cut(*worst);
    worst->final = cut.axis < 0;
    if (worst->final) continue;
    Cell low;
    Cell high;
    halves(*worst, cut, &low, &high, low.fit, high.fit);
    const Cell before = std::exchange(*worst, std::move(low));
    const std::size_t at = static_cast<std::size_t>(worst - cells_.begin());
    cells_.push_back(std::move(high));
    ShadowTiles grid;
    set_tile_grid(grid, cells_of(cells_), limits.cells_a_row);
    if (grid.cells() <= limits.cells && grid.rows <= limits.cells_a_row) continue;
    cells_.pop_back();
    cells_[at] = before;
    cells_[at].final = true;
  }
}

const ShadowTiles& ShadowTileFinder::find(const world::Camera& camera,
                                          const Mat4& camera_from_model, const LightSpace& whole,
                                          std::span<const ShownItem> items,
                                          const TileLimits& limits) {
  const Mat3 camera_turn(camera_from_model);
  const Mat3 light_turn = whole.axes_from_model * glm::transpose(camera_turn);
  frame_.camera = &camera;
  frame_.light_from_camera = Mat4(light_turn);
  frame_.light_from_camera[3] = Vec4(-(light_turn * Vec3(camera_from_model[3])), 1);
  side_ = limits.side;
  image_pixel_ = limits.pixel;
  sun_tangent_ = limits.sun_tangent;
  tiles_ = {{}, whole.axes_from_model, 0, side_, 1, 1};
  texel_ = std::max(whole.extent.x, whole.extent.y) / side_;
  pixel_ = INFINITY;
  finest_ = 0;

  // corners of pixels are looked at too (sampling.h)
  ViewCell view{Vec2(-2), Vec2(camera.width, camera.height) + 2.0, INFINITY, 0};
  const bool perspective = camera.projection == world::Projection::perspective;
  const auto corner_in_view = [](const ShownItem& item, const Vec3& corner) {
    return Vec3(item.box->camera_from_mesh * Vec4(corner, 1));
  };
  for (const ShownItem& item : items)
    for (const Vec3& corner : corners(item.box->low, item.box->high)) {
      const double depth = corner_in_view(item, corner).z;
      view.near = std::min(view.near, depth);
      view.far = std::max(view.far, depth);
    }
  view.far += std::fabs(view.far) * 0x1p-20;
  view.near = std::max(view.near, perspective ? view.far * 0x1p-24 : 0.0);
  if (!(view.far > view.near)) return tiles_;
  pixel_ = pixel_of(view.near);
  if (texel_ <= kMostPixelsATexel * pixel_) return tiles_;

  pieces_.clear();
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    Piece piece;
    piece.item = i;
    const Mat3 linear(items[i].box->camera_from_mesh);
    piece.pad = 2 * items[i].model->meshes()[items[i].mesh].error *
                std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])});
    ViewPiece shape;
    shape.corners = corners(items[i].box->low, items[i].box->high);
    for (Vec3& corner : shape.corners) corner = corner_in_view(items[i], corner);
    add_piece(view, shape, piece);
  }
  refine(view, texel_ / kMostPixelsATexel / pixel_of(1), items);

  cells_.clear();
  Cell& all = cells_.emplace_back();
  all.view = view;
  for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
    all.parts.push_back({i, pieces_[i].shown});
    all.fit.add(pieces_[i].shown, pieces_[i]);
  }
  if (all.parts.empty()) return tiles_;
  pixel_ = pixel_of(all.fit.all.view.low.z);
  if (texel_ <= kMostPixelsATexel * pixel_) return tiles_;

  finer_ = 1;
  cut_up(limits);
  place(cells_, limits);
  return tiles_;
}

}  // namespace panwright::preview
