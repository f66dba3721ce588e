// Methods of interpolation between samples.
#pragma once

#include <cstdint>

namespace panwright::scenario {

enum class Method : std::uint8_t {
  linear,    // rotations: slerp
  cubic,     // continuous velocity, from neighbours
  lagrange,  // a polynomial through values; rotations: of the components, scaled to unit length
  hermite,   // a polynomial through positions and velocities; without velocities as lagrange
};

}  // namespace panwright::scenario
