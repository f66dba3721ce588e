// The GLB container. Private to importers/gltf.
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
  std::vector<std::string> problems;       // of the container; empty: it is sound
  std::size_t extra = 0;                   // bytes behind the end that the header gives
};

bool is_glb(std::string_view bytes);

// The chunks of a GLB file, those that could be found even where the container is damaged.
// Expects: is_glb(bytes).
Container chunks_of(std::string_view bytes);

}  // namespace panwright::importers::gltf
