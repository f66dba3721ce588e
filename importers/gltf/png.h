// PNG pictures in memory. Private to importers/gltf.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace panwright::importers::gltf {

// An 8-bit RGBA picture as PNG; RGB where every alpha is 255. Row 0 is the top row.
// Expects: rgba of 4·width·height, not empty.
std::vector<std::byte> png_of(std::span<const std::uint8_t> rgba, std::uint32_t width,
                              std::uint32_t height);

}  // namespace panwright::importers::gltf
