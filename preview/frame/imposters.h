// Small targets, drawn by themselves and finer than pixels. Private to preview; nothing here needs
// OpenGL. docs/accuracy/imposters.md says why, and how right it is.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "preview/frame/visible_set.h"
#include "preview/renderer.h"
#include "world/camera.h"

namespace panwright::preview {

// A rectangle of the image plane, along the axes of imposters' cameras; tangents, orthographic
// cameras: metres.
struct PlaneRect {
  Vec2 low{INFINITY};
  Vec2 high{-INFINITY};

  double longer_side() const { return std::max(high.x - low.x, high.y - low.y); }
  bool overlaps(const PlaneRect& other) const {
    return low.x < other.high.x && other.low.x < high.x && low.y < other.high.y &&
           other.low.y < high.y;
  }
  void add(const PlaneRect& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
};

// Texels a pixel that an imposter has at least, but for smooth ones.
inline constexpr double kImposterRate = 4;

// Texels that all imposters of an image start with, at most.
inline constexpr double kMostTexels = 1 << 23;

// One or several targets that are drawn by themselves: what a rectangle of the image plane shows,
// in texels. Its camera has the eye and the image plane of the image's camera and is turned in that
// plane, so that edges along rows, columns and diagonals of the image cross the texels at slopes
// that are far from simple fractions, where point samples measure areas best.
struct Imposter {
  std::vector<std::uint32_t> targets;  // into VisibleSet::targets, ascending
  PlaneRect rect;                      // that holds them
  double extent = 0;                   // its longer side, pixels
  std::uint32_t texels = 0;            // along it
  double least_rate = kImposterRate;   // texels a pixel
  // What shadow maps are to be right for, where more texels than it starts with are likely, so that
  // its draws share one map; 0: its texels.
  std::uint32_t shadow_texels = 0;
  // Whether no target that has no imposter may be seen in the rectangle.
  bool alone = true;
  // Whether it is one only if its pixels are as right as is asked (pixel_error_of()).
  bool tried = false;

  // as place_imposter() sets them
  world::Camera camera;  // its pixels are texels
  PlaneRect plane;       // of all texels
  // where the corner of texel (0, 0) lies in the image, and the steps along its rows and columns,
  // pixels
  Vec2 origin{0};
  Vec2 along{0};
  Vec2 down{0};

  // Texels a pixel, along a side.
  double rate() const { return texels / extent; }
};

// Sets the camera and the texels' places.
void place_imposter(const world::Camera& camera, Imposter& imposter);

// The texels along the side of a box that leave so much of the flux of what is round in it,
// relative.
std::uint32_t texels_for(double flux_error);

// Which targets become imposters, and how fine.
//
// Targets whose rectangles overlap share an imposter, so that what hides what is told texel by
// texel. One that is much smaller than the other has its own, which takes the place of the larger
// one's texels. A target that reaches behind the camera has none. A larger target that overlaps
// nothing is tried: the fluxes of glints and trusses are righter by texels than by samples that go
// where the first ones saw something.
class ImposterFinder {
 public:
  // Returns them from the largest to the smallest, unplaced; they stay until the next call.
  //
  //   most_side  texels that a side may have, > 64
  // Cost: O(n log n) of the visible targets, where few overlap.
  std::span<Imposter> find(const world::Camera& camera, const VisibleSet& visible,
                           const RenderOptions& options, std::uint32_t most_side);

 private:
  bool merge_some(double pixels);
  void add_tried();
  std::vector<Imposter> imposters_;
  std::vector<PlaneRect> others_;    // of targets that have none
  std::vector<Imposter> too_large_;  // those of them that may be tried
};

}  // namespace panwright::preview
