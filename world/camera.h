// Cameras: pose and projection (docs/conventions.md 2–4). Everything in double.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "base/diagnostic.h"
#include "base/math.h"
#include "base/result.h"
#include "geometry/ray/ray.h"
#include "sensor/lens.h"

namespace panwright::world {

enum class Projection { perspective, orthographic };

// A camera in the world. Its axes: x right, y down, z along the boresight. A point (X, Y, Z) of the
// camera's frame, metres, falls on pixel
//   perspective    (focal.x·X/Z + principal.x, focal.y·Y/Z + principal.y), Z > 0
//   orthographic   (focal.x·X + principal.x, focal.y·Y + principal.y)
//   distorted      focal·distortion->place(point) + principal
// with (0, 0) the upper left corner of the image; pixel (i, j) covers [i, i+1) × [j, j+1).
struct Camera {
  std::uint32_t width = 1024;   // pixels
  std::uint32_t height = 1024;  // pixels
  Projection projection = Projection::perspective;
  Vec2 focal{1024};     // pixels; orthographic: pixels per metre; > 0
  Vec2 principal{512};  // pixels
  std::shared_ptr<const sensor::DistortionMap> distortion;  // perspective only; null: none
  Vec3 position{0};                                         // world, metres
  Quat world_from_camera{1, 0, 0, 0};
};

// Each sets the image size, square pixels, and the principal point to the image's centre.
//
//   fov      full horizontal angle, radians, in (0, π)
//   ifov     angle of the on-axis pixel, radians, > 0
//   width_m  metres across the image, > 0
void set_field_of_view(Camera& camera, std::uint32_t width, std::uint32_t height, double fov);
void set_pixel_angle(Camera& camera, std::uint32_t width, std::uint32_t height, double ifov);
void set_orthographic(Camera& camera, std::uint32_t width, std::uint32_t height, double width_m);

// Returns the world_from_camera rotation that looks from one point at another.
//
//   up       world direction shown upwards in the image, any non-zero length; none: +z
//   returns  unit quaternion; when up is within 1e-6 rad of the line of sight (either way), +y is
//            up instead, and +z when that is along it too
//
// Reports: N5004 when up was replaced. Fails: E0201 when the two points are equal, or up is 0.
Result<Quat> looking_at(const Vec3& position, const Vec3& target, const std::optional<Vec3>& up,
                        DiagnosticLog& log);

// Puts the camera into a frame (x right, y down, z forward) that rides on a node. Scale of the node
// moves the frame's origin and leaves the axes of unit length; in a mirrored node forward and down
// keep their directions and right follows from them.
void place_in_frame(Camera& camera, const Mat4& world_from_node, const Vec3& origin,
                    const Quat& node_from_frame);

// The world ray through an image point, unit direction. Orthographic rays start on the plane
// through the camera's position. Expects: no distortion.
geometry::Ray pixel_ray(const Camera& camera, const Vec2& pixel);

// The same for any camera; nothing: the distortion has no ray there.
std::optional<geometry::Ray> distorted_ray(const Camera& camera, const Vec2& pixel);

// Returns the share of pixels outside the domain of the camera's distortion, of 4096 over the
// image.
double share_without_ray(const Camera& camera);

// Projects a world point to the image; nothing when it is not in front of the camera, or outside
// the domain of its distortion.
std::optional<Vec2> project(const Camera& camera, const Vec3& point);

// The solid angle of any pixel, steradians, to a relative 1e-15 (7e-16 measured; of one that spans
// 179.9 degrees 4e-14). A sum of L·pixel_solid_angle over an image is the irradiance at the camera.
// With distortion: of the spherical quadrilateral of its corners, so that pixels add up to the
// polygon of the outermost ones; to a relative 1e-16 over the pixel's angle; 0: a corner has no
// ray. Expects: perspective; column < width, row < height.
double pixel_solid_angle(const Camera& camera, std::uint32_t column, std::uint32_t row);

// The area of one pixel on the scene, m². Expects: orthographic.
double pixel_area(const Camera& camera);

// A rigid transform: p' = rotation·p + translation.
struct Pose {
  Vec3 translation{0};        // metres
  Quat rotation{1, 0, 0, 0};  // unit
  Mat4 matrix() const { return matrix_from_trs(translation, rotation, Vec3(1)); }
  bool operator==(const Pose&) const = default;
};

}  // namespace panwright::world
