// STEP (ISO 10303-21, AP203, AP214 and AP242) → scene, by a process of its own, so that OpenCASCADE
// cannot take this one down. Private to importers.
#pragma once

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::step {

// Whether the program that reads STEP files is there. It is looked for in PANWRIGHT_STEP_READER (a
// path), then beside the running program, in its installation, and in that of the library.
bool is_available();

// Reads the products of a file as nodes, each solid meshed once however often it is used. The
// process that does it is held to limits.memory (of address space, libraries beside it) and
// limits.seconds; when it crashes or exceeds them, that is an error with what was found before.
//
// Fails: E0001, E6001, E6002, E6601. Reports E6002, E6601, W6004, W6008, W6009, W6602, N6007.
Result<Imported> read(const InputFile& file, const Options& options, DiagnosticLog& log);

}  // namespace panwright::importers::step
