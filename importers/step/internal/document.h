// A checked text → scene, through OpenCASCADE.
#pragma once

#include <string_view>

#include "importers/import.h"
#include "importers/step/internal/text.h"

namespace panwright::importers::step {

// What is over a limit; becomes E6002.
struct OverLimit {
  std::string_view what;
};

// Reads the products of a text. What OpenCASCADE says goes to the log.
//
//   path  of the file, for the sources of nodes
//   name  as the user would type it
//
// Fails: E6601. Throws OverLimit. Not to be called by two threads at once: OpenCASCADE keeps its
// settings in one place.
Result<Imported> read_document(const Text& text, std::string_view bytes, const std::string& path,
                               const std::string& name, const Options& options, DiagnosticLog& log);

}  // namespace panwright::importers::step
