// Reader of VRML 97 and VRML 1.0. Private to importers.
#pragma once

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::vrml {

// Reads an unpacked file with all files that it names.
//
// Fails: E6002, E6101.
Result<Imported> read(Files& files, const InputFile& file, const Options& options,
                      DiagnosticLog& log);

}  // namespace panwright::importers::vrml
