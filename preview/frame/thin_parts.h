// Parts thinner than the distance of samples, in pixels where no sample shows a target. Private to
// preview; nothing here needs OpenGL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "image/image.h"
#include "pan/model.h"
#include "preview/frame/projection.h"
#include "preview/frame/samples.h"

namespace panwright::preview {

// Finds the pixels of a part where no sample shows a target: 1, else 0; resized.
//
//   corners  an image whose samples lie half a pixel left of and above those of the first: the
//   centre
//            and the corners of a pixel count; null: the centres of the pixel and of all around it
void find_empty(const image::Image& image, const image::Image* corners, const Tile& part,
                std::vector<std::uint8_t>& empty);

// A placed mesh, as samples show it.
struct ThinMesh {
  pan::MeshView mesh;
  Mat4 camera_from_mesh{1};
  bool closed = false;  // one of two triangles faces the camera
};

// Finder of the area that thin triangles cover in pixels without samples of targets. Where centre
// and corners of a pixel show none, no straight edge of something wide crosses it. What does is
// thinner than the samples' distance: booms, wires, plates seen from their edges.
class ThinParts {
 public:
  // empty: of each pixel of the part, row by row, 1 where no sample shows a target
  void begin(const Tile& part, std::span<const std::uint8_t> empty);
  // Adds the triangles of a mesh. Triangles that reach behind the camera are left out.
  // Cost: O(triangles), and the pixels of thin ones.
  void add(const world::Camera& camera, const ThinMesh& mesh);
  // Returns the covered area of each pixel of the part, pixels, at most 1; of overlapping surfaces
  // the sum.
  std::span<const float> areas() const { return areas_; }

 private:
  struct Triangle {
    Vec2 corners[3];  // pixels from the part's corner
  };
  bool may_count(const Triangle& triangle) const;
  void lay(const Triangle& triangle, double weight);

  Tile part_;
  std::vector<float> areas_;
  std::vector<std::uint8_t> empty_;
  std::vector<Pixel> empty_pixels_;  // of begin()
  PixelSet set_;
  std::vector<Vec3> places_;                 // of a mesh's vertices: pixels, 1 before the camera
  std::vector<std::vector<Triangle>> thin_;  // of parts of a mesh
};

}  // namespace panwright::preview
