// Light of a convex mesh for a distant observer: Lambert, smooth normals, no shadows cast.
#pragma once

#include <cmath>

#include "geometry/mesh.h"

namespace panwright::support {

struct Seen {
  double flux = 0;  // ∫ max(0, n·l) over the projected area, m²
  Vec3 moment{0};   // of the flux about the origin, m³
  Vec3 photocentre() const { return moment / flux; }
};

// Sums over side² pieces of each triangle: normals are interpolated and made unit, triangles that
// face away do not count (docs/conventions-models.md 13).
inline Seen seen_by(const geometry::Mesh& mesh, const Vec3& to_light, const Vec3& to_viewer,
                    int side) {
  Seen sum;
  for (const geometry::Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const Vec3 &na = mesh.normals[t[0]], &nb = mesh.normals[t[1]], &nc = mesh.normals[t[2]];
    const double area = 0.5 * glm::dot(glm::cross(b - a, c - a), to_viewer) / (side * side);
    if (!(area > 0)) continue;
    for (int i = 0; i < side; ++i) {
      for (int j = 0; j < 2 * (side - i) - 1; ++j) {
        // upright pieces stand at even j, inverted ones between them
        const double u = (i + (j % 2 + 1) / 3.0) / side, v = (j / 2 + (j % 2 + 1) / 3.0) / side;
        const Vec3 n = glm::normalize((1 - u - v) * na + u * nb + v * nc);
        const double flux = std::fmax(0.0, glm::dot(n, to_light)) * area;
        sum.flux += flux;
        sum.moment += flux * ((1 - u - v) * a + u * b + v * c);
      }
    }
  }
  return sum;
}

}  // namespace panwright::support
