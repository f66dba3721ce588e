// Reader of glTF 2.0 and GLB. Private to importers.
#pragma once

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::gltf {

// Reads a file with all files that it names.
//
// Fails: E6201, E6202, E6203, E6209; E6204 for JSON that is no object; E6205 for a missing scene.
// Reports E6002, E6204 to E6215, W6004, W6005, N6007, W6008, W6009.
Result<Imported> read(Files& files, const InputFile& file, const Options& options,
                      DiagnosticLog& log);

}  // namespace panwright::importers::gltf
