// What the fuzzers of glTF, mesh and image files run on each input. They abort when something that
// must hold does not.
#pragma once

#include <cstddef>
#include <span>

namespace panwright::fuzz {

// Reads the bytes as a glTF or GLB file whose buffers and textures may be the same bytes, checks
// the scene, compiles it, checks the pan file that results, and writes that as GLB.
void gltf(std::span<const std::byte> input);

// Reads the bytes as the Draco stream of an otherwise sound GLB file.
void draco(std::span<const std::byte> input);

// Reads the bytes as an OBJ file that is its own material library and as an STL file, or as PLY
// where they begin so; checks what comes of it.
void mesh(std::span<const std::byte> input);

// Decodes the bytes as an image; checks its size.
void image(std::span<const std::byte> input);

}  // namespace panwright::fuzz
