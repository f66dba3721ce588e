// Exact shapes, as the author gave them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>

#include "geometry/mesh.h"

namespace panwright::geometry {

// Explicit tessellation of a sphere: rings latitude bands from pole to pole, quads segments around
// the axis, the first meridian at +x. 2·quads·(rings−1) triangles.
struct SphereCounts {
  std::uint32_t rings;  // ≥ 2
  std::uint32_t quads;  // ≥ 3
  bool operator==(const SphereCounts&) const = default;
};

// A sphere about the origin, poles on ±z.
struct Sphere {
  double radius = 1;                   // metres, > 0
  std::optional<SphereCounts> counts;  // none: as many as the allowed error needs
  bool operator==(const Sphere&) const = default;
};

// A mesh as written in a file: exact by definition. Never null.
using MeshShape = std::shared_ptr<const Mesh>;

using Shape = std::variant<Sphere, MeshShape>;

}  // namespace panwright::geometry
