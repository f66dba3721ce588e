// Fuzz target of trajectory files. It aborts on a violated invariant.
#pragma once

#include <cstddef>
#include <span>

namespace panwright::fuzz {

// Reads the bytes with each reader of scenario. What can be read has ascending times, and finite
// frames with unit rotations at its own times and between them; what cannot has an error.
//
//   returns  number of readers that read it
std::size_t scenario(std::span<const std::byte> input);

}  // namespace panwright::fuzz
