// Readers of the three mesh formats. Private to importers/meshes.
#pragma once

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::meshes {

// Reads Wavefront OBJ with MTL. Reports E6002, E6501, W6004, W6005, W6502, N6007, W6008.
Result<Imported> read_obj(Files& files, const InputFile& file, const Options& options,
                          DiagnosticLog& log);

// Reads STL: binary if its size is 84 + 50·n bytes, whatever the header begins with. Reports E6002,
// E6501, W6502.
Result<Imported> read_stl(Files& files, const InputFile& file, const Options& options,
                          DiagnosticLog& log);

// Reads PLY of any byte order. Reports E6002, E6501, W6004, W6005, W6502, N6007, W6008.
Result<Imported> read_ply(Files& files, const InputFile& file, const Options& options,
                          DiagnosticLog& log);

}  // namespace panwright::importers::meshes
