// Fuzz target of elevation files and shape models. It aborts on a violated invariant.
#pragma once

#include <cstddef>
#include <span>

namespace panwright::fuzz {

// Reads the bytes as an elevation file, beside data that labels may name, and as a shape
// model. What can be read has all its posts, finite where not void; what cannot has an error.
//
//   returns  whether it was read as one of them
bool terrain(std::span<const std::byte> input);

}  // namespace panwright::fuzz
