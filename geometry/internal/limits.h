// Numbers that several files of geometry share: no index, the largest mesh, coincidence of points
// and angles.
#pragma once

#include <cstdint>

namespace panwright::geometry {

inline constexpr std::uint32_t kNone = 0xffffffffu;  // no vertex, triangle, edge or point
// Vertices of a mesh at most: an index has 32 bits, and the last is kNone.
inline constexpr std::uint64_t kMaxVertices = 0xffffffffu;
inline constexpr double kMostVertices = 4294967295.0;  // the same among doubles
inline constexpr double kAngleSlack = 1e-9;            // radians: the rounding of an angle
inline constexpr double kCoincident =
    1e-9;  // neighbouring points closer than this share of the whole are one
inline constexpr double kStraight = 1e-12;  // radians: a bend smaller than this is none

}  // namespace panwright::geometry
