// Component files of a model in another format. Private to importers.
#pragma once

#include <string>

#include "importers/import.h"

namespace panwright::importers {

// Reads a file found earlier, as import_from() does; refuses one that itself consists of other
// models (E6001). Its own input comes first among those of the scene.
Result<Imported> import_part(Files& files, const std::string& path, SharedText bytes,
                             const Options& options, DiagnosticLog& log, SourceSpan included_at,
                             const Job& job);

}  // namespace panwright::importers
