// STEP → scene, in this process: what panwright-step does. Private to it and its tests.
#pragma once

#include <functional>

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::step {

// Reads the products of a file as nodes, each solid meshed once however often it is used.
//
//   before_risk  called before OpenCASCADE is given something to do, so that what is reported so
//   far
//                can be told
//
// Fails: E6601. Reports E6002, E6601, W6602, N6007, W6008, W6009. Not to be called by two threads
// at once: OpenCASCADE keeps its settings in one place.
Result<Imported> read_in_process(const InputFile& file, const Options& options, DiagnosticLog& log,
                                 const std::function<void()>& before_risk = {});

}  // namespace panwright::importers::step
