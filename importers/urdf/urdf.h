// Reader of URDF robot descriptions. Private to importers.
#pragma once

#include <string_view>

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::urdf {

// Returns true if the first element of a text is <robot>.
bool is_robot(std::string_view text);

// Reads an unpacked file with its meshes and textures. Each link is a node whose transform is the
// origin of its parent joint, which moves that node. A floating joint becomes a general one, a
// planar one two prismatic ones, "NAME x" and "NAME y".
//
// Fails: E6002, E6220 without links. Reports E6001, E6010, E6220, W6004, W6005, W6221, N6007,
// W6008, and those of mesh readers.
Result<Imported> read(Files& files, const InputFile& file, const Options& options,
                      DiagnosticLog& log);

}  // namespace panwright::importers::urdf
