// Fuzz targets of glTF, mesh and image files. They abort on a violated invariant.
#pragma once

#include <cstddef>
#include <span>

namespace panwright::fuzz {

// Reads the bytes as a glTF or GLB file whose buffers and textures may be the same bytes. Checks
// the scene, compiles it, checks the pan file, and writes that as GLB.
void gltf(std::span<const std::byte> input);

// Reads the bytes as the Draco stream of an otherwise valid GLB file.
void draco(std::span<const std::byte> input);

// Reads the bytes as an OBJ file that is its own material library and as an STL file, or as PLY by
// their beginning; checks the result.
void mesh(std::span<const std::byte> input);

// Decodes the bytes as an image; checks its size.
void image(std::span<const std::byte> input);

}  // namespace panwright::fuzz
