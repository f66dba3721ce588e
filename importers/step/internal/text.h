// Text of an exchange structure (ISO 10303-21), checked before OpenCASCADE reads it. Finds broken
// statements and entities that contain themselves, which OpenCASCADE does not survive.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"

namespace panwright::importers::step {

// An entity instance of the data sections: "#12=…;".
struct Entity {
  std::uint64_t number = 0;
  std::uint32_t begin = 0;  // bytes [begin, end) of the file
  std::uint32_t end = 0;
};

struct Text {
  FileId file = kNoFile;
  std::string repaired;          // valid statements alone, in place; empty: the file unchanged
  std::vector<Entity> entities;  // the valid ones, by number
  bool usable = false;
};

// Checks statement by statement. A broken one is reported and left out with its dependants: a face
// only leaves its shell, but a surface removes its face. A truncated text is completed. Statements
// that name other files are left out: only the file itself is read.
//
//   without  numbers of further entities to leave out
//
// Reports E6601, and W6004 for other files. Not usable: no header, no entity, an entity that
// contains itself, or references nested deeper than max_depth (E6002).
// Cost: O(bytes log entities); memory of 32 bytes an entity and 12 a reference.
Text checked(std::string_view bytes, FileId file, std::uint32_t max_depth, DiagnosticLog& log,
             std::span<const std::uint64_t> without = {});

// Returns the place of an entity, or the file as a whole.
SourceSpan place_of(const Text& text, std::uint64_t number);

}  // namespace panwright::importers::step
