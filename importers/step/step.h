// STEP (ISO 10303-21, AP203, AP214 and AP242) → scene. Private to importers; built where
// PANWRIGHT_STEP is on.
#pragma once

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::step {

// Reads the products of a file as nodes, each solid meshed once however often it is used.
//
// Fails: E6601. Reports E6002, E6601, W6602, N6007, W6009.
Result<Imported> read(const InputFile& file, const Options& options, DiagnosticLog& log);

}  // namespace panwright::importers::step
