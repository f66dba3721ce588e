// Conversion of a checked text to a scene, through OpenCASCADE.
#pragma once

#include <string_view>
#include <vector>

#include "importers/import.h"
#include "importers/step/internal/text.h"

namespace panwright::importers::step {

// Exceeded limit; becomes E6002.
struct OverLimit {
  std::string_view what;
};

// Shapes, or their constituents, that hold an entity of a wrong kind, at which OpenCASCADE would
// crash.
struct Torn {
  std::vector<std::uint64_t> numbers;  // of entities; not empty
};

// Reads the products of a text. Messages of OpenCASCADE go to the log.
//
//   path  of the file, for the sources of nodes
//   name  for messages
//
// Fails: E6601. Throws OverLimit, Cancelled, and Torn before anything is reported. Not thread-safe:
// OpenCASCADE's settings are global.
Result<Imported> read_document(const Text& text, std::string_view bytes, const std::string& path,
                               const std::string& name, const Options& options, DiagnosticLog& log,
                               const Job& job);

}  // namespace panwright::importers::step
