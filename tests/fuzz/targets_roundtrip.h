// Round trip of pan files: whatever the source, the reader accepts the writer's output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace panwright::fuzz {

// Source formats of a model, in the order of roundtrip()'s first byte.
enum class Source : std::uint8_t { pxn, vrml, gltf, obj, stl, ply, urdf, mjcf, step, count };

// Reads bytes as a file of one kind, compiles it, writes the pan, plain and compressed, reads both
// back, and compares: with the scene, with each other, and with the output of a second run. Aborts
// on a violated invariant.
//
//   returns  true if it gave a pan
bool roundtrip(Source source, std::span<const std::byte> input);

// Takes the kind from the first byte; STEP, which needs a process, is left out.
void roundtrip(std::span<const std::byte> input);

}  // namespace panwright::fuzz
