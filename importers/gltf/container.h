// GLB container. Private to importers/gltf.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace panwright::importers::gltf {

struct Container {
  std::string_view json;
  std::optional<std::string_view> binary;  // the BIN chunk
  std::vector<std::string> problems;       // of the container; empty: valid
  std::size_t extra = 0;                   // bytes behind the end that the header gives
};

bool is_glb(std::string_view bytes);

// Returns the chunks of a GLB file, as far as found in a damaged one.
// Expects: is_glb(bytes).
Container chunks_of(std::string_view bytes);

}  // namespace panwright::importers::gltf
