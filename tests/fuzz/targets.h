// Fuzz targets. They abort on a violated invariant.
#pragma once

#include <cstddef>
#include <span>

namespace panwright::fuzz {

// Reads the bytes as a pxn file that can include itself, checks the scene, compiles it and checks
// the pan file that results.
void pxn(std::span<const std::byte> input);

// Opens the bytes as a pan file, checks it, and reads all contents of a checked file.
void pan(std::span<const std::byte> input);

// Reads the bytes as a VRML file of either version that can inline itself, checks the scene,
// compiles it and checks the pan file.
void vrml(std::span<const std::byte> input);

}  // namespace panwright::fuzz
