// Formats of 3D models known by name but not readable.
#pragma once

#include <optional>
#include <string_view>

namespace panwright::importers {

struct OtherFormat {
  std::string_view name;    // "FBX", "a Blender file"
  std::string_view advice;  // "convert it to glTF (.glb) with Blender"
};

// Identifies a format by its first bytes. Nothing for readable and unknown formats.
//
//   path  its name, to distinguish formats with equal beginnings (ZIP archives)
std::optional<OtherFormat> other_format_by_bytes(std::string_view bytes, std::string_view path);

// The same by the name's extension, in any letter case, before ".gz" or ".gzip" if present.
std::optional<OtherFormat> other_format_by_name(std::string_view path);

}  // namespace panwright::importers
