// Tiled shadow maps for close views: if one map of the whole target is too coarse, tiles of one
// texture, each fitted to a part of the view. Private to preview; nothing here needs OpenGL.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "pan/model.h"
#include "preview/frame/light_space.h"
#include "preview/frame/projection.h"
#include "preview/frame/view_pieces.h"
#include "preview/gl/uniforms.h"
#include "preview/model/mesh_runs.h"

namespace panwright::preview {

// Largest width of a map's texel in pixels at its nearest receivers: 99 of 100 edges are then right
// to 0.75 pixels (0.375 texels measured, bench/case_shadows.cpp).
inline constexpr double kMostPixelsATexel = 2;
inline constexpr double kEdgeOfTexel = 0.375;  // texels: error of 99 of 100 edges

// Square part of a map.
struct ShadowTile {
  Vec3 low{0};       // its corner in light space, metres
  double texel = 0;  // metres
  unsigned x = 0;    // texels, in the map
  unsigned y = 0;
  unsigned side = 0;  // texels
  double margin = 0;  // its border for rays to the Sun's disc, texels
  bool operator==(const ShadowTile&) const = default;
};

// Tiles of one map. Depths are in texels of each, so that a slope is the same number in all.
struct ShadowTiles {
  std::vector<ShadowTile> tiles;  // the finest first; none: one map of the whole target
  Mat3 light_from_model{1};       // a rotation
  double depth = 0;               // of each tile, in its texels
  unsigned side = 0;              // texels, of one cell
  unsigned columns = 1;           // cells
  unsigned rows = 1;
  bool operator==(const ShadowTiles&) const = default;

  std::size_t cells() const { return std::size_t{columns} * rows; }
};

// Returns the light space of a single tile, and with x and y across the whole map.
LightSpace light_space_of_tile(const ShadowTiles& tiles, std::size_t tile);
LightSpace light_space_in_map(const ShadowTiles& tiles, std::size_t tile);

// Returns the range of a tile in the map: x and y from, x and y to.
Vec4 inside_of_tile(const ShadowTiles& tiles, std::size_t tile);

// Item of a receiver in view.
struct ShownItem {
  const PlacedBox* box = nullptr;
  std::shared_ptr<const void> owner;  // of its model
  const pan::Model* model = nullptr;
  std::uint32_t mesh = 0;
};

struct TileLimits {
  unsigned side = 2048;         // texels of a cell
  std::size_t cells = 1;        // at most, of the map
  std::size_t cells_a_row = 1;  // at most
  double pixel = 1;             // size in camera pixels: of the image, or of an imposter's texel
  double sun_tangent = 0;       // of the angular radius of the Sun's disc; 0: a point
};

class ShadowTileFinder {
 public:
  // Finds tiles for the visible parts of receivers; none if texels of `whole` are fine enough.
  // Repeatedly cuts the part of the view with the coarsest texels in two, along its depth or across
  // the image, at the best place. Ends when all are fine enough or a limit is reached.
  //
  //   whole              the light space of everything, in the frame of the map's anchor
  //   camera_from_model  of the anchor, rigid
  // Cost: O(items · tiles), and a pass over the meshes close to the camera.
  const ShadowTiles& find(const world::Camera& camera, const Mat4& camera_from_model,
                          const LightSpace& whole, std::span<const ShownItem> items,
                          const TileLimits& limits);

  // Of the last find(): the coarsest texel relative to its pixel, and that pixel. Metres.
  double texel() const { return texel_; }
  double pixel() const { return pixel_; }
  // Limit of single precision on the texel there, metres; 0: any.
  double finest() const { return finest_; }

 private:
  // Piece and its origin.
  struct Piece {
    ViewPiece shape;
    double pad = 0;  // largest displacement of a point, metres
    std::uint32_t item = 0;
    std::uint32_t first = 0;  // triangles of a run
    std::uint32_t count = 0;
    ShownPart shown;  // in the whole view
  };
  // Requirements of a list of parts.
  struct Fit {
    ShownPart all;
    double across = 0;  // of the largest piece, metres
    double deep = 0;
    void add(const ShownPart& part, const Piece& piece);
  };
  struct Part {
    std::uint32_t piece = 0;
    ShownPart shown;
  };
  struct Cell {
    ViewCell view;
    std::vector<Part> parts;
    Fit fit;
    bool final = false;
  };
  struct Cut {
    int axis = -1;
    double at = 0;
  };

  double pixel_of(double depth) const;
  static double finest_of(const Fit& fit);
  double margin_of(unsigned side) const;
  double texel_of(const Fit& fit, unsigned side) const;
  unsigned level_of(const Fit& fit) const;
  double coarseness(const Fit& fit) const {
    return texel_of(fit, side_) / pixel_of(fit.all.view.low.z);
  }
  void add_piece(const ViewCell& view, const ViewPiece& shape, const Piece& from);
  void refine(const ViewCell& view, double most, std::span<const ShownItem> items);
  void cut_up(const TileLimits& limits);
  Cut best_cut(const Cell& cell) const;
  void find_gap(const Cell& cell, int axis, std::vector<Cut>& cuts) const;
  void halves(const Cell& cell, const Cut& cut, Cell* low, Cell* high, Fit& low_fit,
              Fit& high_fit) const;
  std::size_t cells_of(std::span<const Cell> cells) const;
  void place(std::span<const Cell> cells, const TileLimits& limits);

  ViewFrame frame_;
  unsigned side_ = 0;
  double image_pixel_ = 1;
  double sun_tangent_ = 0;
  double finer_ = 1;  // texels a pixel of tiles, at least
  double texel_ = 0;
  double pixel_ = 0;
  double finest_ = 0;
  MeshRunCache runs_;
  std::vector<Piece> pieces_;
  std::vector<Piece> coarse_;
  std::vector<Cell> cells_;
  ShadowTiles tiles_;
};

}  // namespace panwright::preview
