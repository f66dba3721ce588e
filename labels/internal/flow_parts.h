// Parts of the two kinds of flow. Private to labels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "image/image.h"
#include "labels/flow.h"
#include "labels/internal/image_plane.h"
#include "trace/placement.h"

namespace panwright::labels {

// Nodes of a target in camera axes; metres.
struct NodesInCamera {
  std::vector<trace::Affine> camera_from_node;
  std::vector<std::uint8_t> visible;  // 0 or 1, and of a finite place
};

// By target, in the world's order.
std::vector<NodesInCamera> nodes_in_camera(const Moment& moment);

// Returns the inverse, not finite for singular maps.
trace::Affine inverse_of(const trace::Affine& affine);

// Surface at a pixel's centre.
struct SurfacePoint {
  Vec3 point;  // metres, camera axes
  std::uint32_t target = 0, node = 0;
};

// By depth and range of an image with ground truth; none: background.
//
//   ray  of the pixel's centre, in the camera's axes
std::optional<SurfacePoint> surface_of_layers(const image::Image& layers, const ImagePlane& plane,
                                              std::size_t pixel, const trace::Ray& ray);

}  // namespace panwright::labels
