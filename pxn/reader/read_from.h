// Reading with files from any source.
#pragma once

#include "pxn/pxn.h"
#include "pxn/reader/files.h"

namespace panwright::pxn {

// Reads as pxn::read.
Result<scene::Scene> read_from(Files& files, const FoundFile& top, const Options& options,
                               DiagnosticLog& log, const Job& job = {});

}  // namespace panwright::pxn
