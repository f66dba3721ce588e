// What the writer of pan files writes, its reader takes, whatever was read before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace panwright::fuzz {

// Files that a model can come from, in the order of roundtrip()'s first byte.
enum class Source : std::uint8_t { pxn, vrml, gltf, obj, stl, ply, urdf, mjcf, step, count };

// Reads bytes as a file of one kind, compiles it, writes the pan, plain and compressed, reads both
// back, and compares: with the scene, with each other, and with what a second run writes. Aborts
// when something that must hold does not.
//
//   returns  whether a pan came of it
bool roundtrip(Source source, std::span<const std::byte> input);

// The first byte says which kind the others are; STEP, which needs a process, is left out.
void roundtrip(std::span<const std::byte> input);

}  // namespace panwright::fuzz
