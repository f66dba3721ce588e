// Reader of STEP (ISO 10303-21, AP203, AP214 and AP242) in a process of its own, so that a crash of
// OpenCASCADE does not end this one. Private to importers.
#pragma once

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::step {

// Returns true if the program that reads STEP files is found: in PANWRIGHT_STEP_READER (a path),
// then beside the running program, in its installation, and in that of the library.
bool is_available();

// Reads the products of a file as nodes, each solid meshed once. The reading process is bound by
// limits.memory (of address space, excluding libraries) and limits.seconds; a crash or excess is an
// error, and earlier results remain.
//
// Fails: E0001, E6001, E6002, E6601. Reports E6002, E6601, W6004, W6008, W6009, W6602, N6007.
Result<Imported> read(const InputFile& file, const Options& options, DiagnosticLog& log);

}  // namespace panwright::importers::step
