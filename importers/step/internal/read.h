// Reader of STEP in this process, as used by panwright-step. Private to it and its tests.
#pragma once

#include <functional>

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::step {

// Reads the products of a file as nodes, each solid meshed once.
//
//   before_risk  called before each use of OpenCASCADE, so that earlier reports can be sent
//
// Fails: E6601. Reports E6002, E6601, W6602, N6007, W6008, W6009. Not thread-safe: OpenCASCADE's
// settings are global.
Result<Imported> read_in_process(const InputFile& file, const Options& options, DiagnosticLog& log,
                                 const std::function<void()>& before_risk = {});

}  // namespace panwright::importers::step
