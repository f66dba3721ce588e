// A checked text → scene, through OpenCASCADE.
#pragma once

#include <string_view>
#include <vector>

#include "importers/import.h"
#include "importers/step/internal/text.h"

namespace panwright::importers::step {

// What is over a limit; becomes E6002.
struct OverLimit {
  std::string_view what;
};

// Shapes, or what they are made of, that hold something of a wrong kind: OpenCASCADE would follow
// it into nothing.
struct Torn {
  std::vector<std::uint64_t> numbers;  // of entities; not empty
};

// Reads the products of a text. What OpenCASCADE says goes to the log.
//
//   path  of the file, for the sources of nodes
//   name  as the user would type it
//
// Fails: E6601. Throws OverLimit, Cancelled, and Torn before anything is reported. Not to be called by two
// threads at once: OpenCASCADE keeps its settings in one place.
Result<Imported> read_document(const Text& text, std::string_view bytes, const std::string& path,
                               const std::string& name, const Options& options, DiagnosticLog& log,
                               const Job& job);

}  // namespace panwright::importers::step
