// Data URIs. Private to importers/gltf.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace panwright::importers::gltf {

struct DataUri {
  std::string media_type;
  std::string bytes;
};

bool is_data_uri(std::string_view uri);

// Decodes a data URI; nothing if malformed. Expects: is_data_uri(uri).
std::optional<DataUri> data_of(std::string_view uri);

}  // namespace panwright::importers::gltf
