// Connected faces of a mesh, by short names for those of geometry.
#pragma once

#include "geometry/mesh/face_groups.h"

namespace panwright::mli {

using geometry::area_of;
using geometry::chosen_faces;
using geometry::connected;
using geometry::diagonal_of;
using geometry::Faces;
using geometry::flat_parts;
using Group = geometry::FaceGroup;

inline constexpr std::uint32_t kNone = geometry::kNoNeighbour;

}  // namespace panwright::mli
