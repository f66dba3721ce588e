// The text of an exchange structure (ISO 10303-21), looked at before OpenCASCADE reads it: what it
// does not bear (broken statements, entities that contain themselves) is found here, with its
// place.
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
  std::string repaired;  // sound statements alone, at their places; empty: the file as it is
  std::vector<Entity> entities;  // the sound ones, by number
  bool usable = false;
};

// Checks statement by statement. A broken one is left out and said, with what cannot be without it:
// a face goes from its shell, but a surface takes its face along. A text that ends too early is
// ended. Statements that name other files are left out: only the file itself is read.
//
//   without  numbers of entities to leave out as well
//
// Reports E6601, and W6004 for other files. Not usable: no header, no entity, an entity that
// contains itself, or references nested deeper than max_depth (E6002).
// Cost: O(bytes log entities); memory of 32 bytes an entity and 12 a reference.
Text checked(std::string_view bytes, FileId file, std::uint32_t max_depth, DiagnosticLog& log,
             std::span<const std::uint64_t> without = {});

// Where an entity is written, or the file as a whole.
SourceSpan place_of(const Text& text, std::uint64_t number);

}  // namespace panwright::importers::step
