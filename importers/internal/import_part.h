// Files that a model of another format is made of. Private to importers.
#pragma once

#include <string>

#include "importers/import.h"

namespace panwright::importers {

// Reads a file that was found already, as import_from() does; one that consists of other models
// itself is refused (E6001). Its own input comes first among those of the scene.
Result<Imported> import_part(Files& files, const std::string& path, SharedText bytes,
                             const Options& options, DiagnosticLog& log, SourceSpan included_at,
                             const Job& job);

}  // namespace panwright::importers
