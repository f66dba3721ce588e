// glTF 2.0 and GLB → scene. Private to importers.
#pragma once

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::gltf {

// Reads a file with all that it names.
//
// Fails: E6002, E6201, E6202, E6203.
Result<Imported> read(Files& files, const InputFile& file, const Options& options,
                      DiagnosticLog& log);

}  // namespace panwright::importers::gltf
