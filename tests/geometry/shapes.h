// Small meshes with known properties.
#pragma once

#include <cstdint>

#include "geometry/mesh.h"
#include "geometry/mesh/check.h"
#include "geometry/tessellate/tessellate.h"

namespace panwright::geometry::shapes {

// The cube [-1, 1]³: 8 vertices, 12 triangles, outward.
inline Mesh cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back({i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
  const std::uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  mesh.closed = true;
  return mesh;
}

inline Mesh sphere(std::uint32_t rings, std::uint32_t quads, double radius = 1,
                   bool texcoords = false) {
  DiagnosticLog log;
  TessellationOptions options;
  options.texcoords = texcoords;
  return *tessellated(Sphere{radius, SphereCounts{rings, quads}}, options, {}, log);
}

// Random numbers in [0, 1), the same everywhere (SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double operator()() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  double between(double low, double high) { return low + (high - low) * (*this)(); }
  Vec3 direction() {
    for (;;) {
      const Vec3 v(between(-1, 1), between(-1, 1), between(-1, 1));
      const double squared = glm::dot(v, v);
      if (squared > 1e-6 && squared <= 1) return v / std::sqrt(squared);
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace panwright::geometry::shapes
