// Flat faces of a mesh, and coordinates in metres along their edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"
#include "geometry/mesh.h"

namespace panwright::geometry {

// Source of a face's coordinates.
enum class FaceLayout : std::uint8_t {
  none,       // it has none
  file,       // its texture coordinates, which are unsheared and lie along its longest border edge
  rectangle,  // it is a rectangle: along its sides, the origin at a corner
};

struct FlatFace {
  FaceLayout layout = FaceLayout::none;
  double area = 0;  // m²
  // Coordinates of a point p, metres: (u·p + origin.x, v·p + origin.y). u and v are perpendicular
  // unit vectors along the face and its longest border edge. rectangle: from 0 to the sides,
  // right-handed from outside, u along the longer side. file: u, v and the point 0, 0 of the file.
  Vec3 u{0};
  Vec3 v{0};
  Vec2 origin{0};
};

inline constexpr std::uint32_t kNoFace = 0xffffffffu;

struct FlatFaces {
  std::vector<std::uint32_t> face_of;  // T: index into faces; kNoFace: a triangle without area
  std::vector<FlatFace> faces;         // largest triangle first
};

// Limits of flat, straight, unsheared and aligned faces.
struct FlatFaceLimits {
  double cos_flat = 0.99984769515639124;  // cos 1°: normals of a face against its largest triangle
  double sin_flat = 0.017452406437283512;  // sin 1°: bends of an edge; coordinates against edges
  double flat = 1e-4;      // of the diagonal of the bounds: distance from a face's plane
  double stretch = 1.01;   // of coordinates: largest stretch / smallest
  double residual = 0.01;  // of √area: distance of coordinates from the fitted affine map
  double border = 5e-3;    // of the shorter side: distance of a border from its rectangle
};

// Groups connected triangles of one plane, from the largest on. Vertices at equal positions count
// as one. Of a square, u is the side nearer to x (then y, z).
//
//   positions  V, metres
//   texcoords  V, or empty
//   triangles  T, each index < V
//
// Expects: finite positions. Edges of more than 8 triangles connect nothing.
// Cost: O((V + T) log T).
FlatFaces flat_faces(std::span<const Vec3> positions, std::span<const Vec2> texcoords,
                     std::span<const Triangle> triangles, const FlatFaceLimits& limits = {});

}  // namespace panwright::geometry
