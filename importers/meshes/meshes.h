// Readers of OBJ, STL and PLY. Private to importers.
#pragma once

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::meshes {

// Reads a file with its material libraries and textures.
//
//   format  obj, stl or ply
//
// Fails: E6501 without any triangle. Reports E6002, E6501, W6502, W6004, W6005, N6007, W6008.
Result<Imported> read(Files& files, const InputFile& file, Format format, const Options& options,
                      DiagnosticLog& log);

}  // namespace panwright::importers::meshes
