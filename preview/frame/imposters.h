// Imposters: small targets, drawn separately and finer than pixels. Private to preview; nothing
// here needs OpenGL. Reasons and accuracy: docs/accuracy/imposters.md.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/axis_box.h"
#include "preview/frame/visible_set.h"
#include "preview/renderer.h"
#include "world/camera.h"

namespace panwright::preview {

// Rectangle of the image plane, along the axes of imposters' cameras; tangents, orthographic
// cameras: metres.
using PlaneRect = AxisRectangle;

// Returns true if two rectangles share an area.
inline bool overlap(const PlaneRect& a, const PlaneRect& b) {
  return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
}

// Fewest texels a pixel of an imposter, except smooth ones.
inline constexpr double kImposterRate = 4;

// Limit of initial texels of all imposters of an image.
inline constexpr double kMostTexels = 1 << 23;

// Rectangle of the image plane with one or several targets, drawn in texels. Its camera shares the
// image camera's eye and image plane, rotated in that plane. Rows, columns and diagonals of the
// image then cross the texels at slopes far from simple fractions, for which point samples measure
// areas best.
struct Imposter {
  std::vector<std::uint32_t> targets;  // into VisibleSet::targets, ascending
  PlaneRect rect;                      // bounds of the targets
  double extent = 0;                   // its longer side, pixels
  std::uint32_t texels = 0;            // along it
  double least_rate = kImposterRate;   // texels a pixel
  // Texels that size the shadow maps, if more texels than the initial ones are likely, so that its
  // draws share one map; 0: its texels.
  std::uint32_t shadow_texels = 0;
  // True if no target without an imposter may be visible in the rectangle.
  bool alone = true;
  // True if it is kept only when its pixels meet the requested error (pixel_error_of()).
  bool tried = false;
  // True if shadow maps are finer than its texels ask for: relief changes much of its flux.
  bool fine_shadows = false;

  // set by place_imposter()
  world::Camera camera;  // its pixels are texels
  PlaneRect plane;       // of all texels
  // place of the corner of texel (0, 0) in the image, and the steps along its rows and columns,
  // pixels
  Vec2 origin{0};
  Vec2 along{0};
  Vec2 down{0};

  // Texels a pixel, along a side.
  double rate() const { return texels / extent; }
};

// Sets the camera and the positions of texels.
void place_imposter(const world::Camera& camera, Imposter& imposter);

// Returns the texels along the side of a box that leave a relative error of the flux of round
// shapes in it.
std::uint32_t texels_for(double flux_error);

// Target error of the flux of an imposter. tried: as Imposter::tried
double flux_error_asked(const RenderOptions& options, bool tried);

// Choice of the targets that become imposters, and of their resolution.
//
// Targets whose rectangles overlap share an imposter, so that occlusion is resolved per texel. One
// much smaller than the other has its own, which replaces the larger one's texels. A target that
// reaches behind the camera has none. A larger target without overlaps is tried where its flux or
// its photocentre is asked for: texels give more accurate fluxes of glints and trusses than
// adaptive samples, which cost less.
class ImposterFinder {
 public:
  // Returns them from the largest to the smallest, unplaced; they stay until the next call.
  //
  //   most_side  texels that a side may have, > 64
  // Cost: O(n log n) of the visible targets, if few overlap.
  std::span<Imposter> find(const world::Camera& camera, const VisibleSet& visible,
                           const RenderOptions& options, std::uint32_t most_side);

 private:
  bool merge_some(double pixels);
  void add_tried();
  std::vector<Imposter> imposters_;
  std::vector<PlaneRect> others_;    // of targets without imposters
  std::vector<Imposter> too_large_;  // candidates among them
};

}  // namespace panwright::preview
