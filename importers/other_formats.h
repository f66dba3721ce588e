// Formats of 3D models that are known by name and not read.
#pragma once

#include <optional>
#include <string_view>

namespace panwright::importers {

struct OtherFormat {
  std::string_view name;    // "FBX", "a Blender file"
  std::string_view advice;  // "convert it to glTF (.glb) with Blender"
};

// What a file is, by its first bytes. Nothing for what is read, and for what is not known.
//
//   path  its name, where that tells apart what begins alike (ZIP archives)
std::optional<OtherFormat> other_format_by_bytes(std::string_view bytes, std::string_view path);

// The same by the name's extension, in any letter case, that below ".gz" where there is one.
std::optional<OtherFormat> other_format_by_name(std::string_view path);

}  // namespace panwright::importers
