// URDF robot descriptions → scene. Private to importers.
#pragma once

#include <string_view>

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::urdf {

// Whether the first element of a text is <robot>.
bool is_robot(std::string_view text);

// Reads an unpacked file with the meshes and textures that it names. Each link is a node whose
// transform is the origin of the joint that it hangs on; the joint moves that node. A joint that
// floats is a general one, a planar one two prismatic ones, "NAME x" and "NAME y".
//
// Fails: E6002, E6220 where there is no link. Reports E6001, E6010, E6220, W6004, W6005, W6221,
// N6007, W6008, and what readers of meshes report.
Result<Imported> read(Files& files, const InputFile& file, const Options& options,
                      DiagnosticLog& log);

}  // namespace panwright::importers::urdf
