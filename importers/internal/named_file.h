// Files named by models: all readers look for them here. Private to importers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "importers/files.h"

namespace panwright::importers {

// Hint for files outside the folder.
inline constexpr const char* kRootHint = "--root FOLDER takes files from all of FOLDER";

struct FileName {
  std::string_view text;               // as written
  std::vector<std::string> including;  // paths of files that it is relative to, best first
  bool percent_encoded = false;
  // A part of the model's shape. An absolute name, as of another machine, leads to the file of its
  // last part beside the model; for textures and the like so does any that leads out of the folder.
  bool part = false;
};

struct NamedFile {
  Files::Outcome outcome = Files::Outcome::missing;
  std::string path;  // as in Files; not found: the first one looked at, or empty
  SharedText bytes;
  std::string problem;    // not found: one lower-case sentence
  std::string deviation;  // found under another name than the written one: a warning. Or empty
  bool outside = false;   // not found, and a wider folder may hold it
};

// Looks for a file by its exact name, then in any letter case, then by its last part.
// package://NAME/… and model://NAME/… are NAME/… or … in the folder of the model and those above
// it. Declares a file that is not there.
NamedFile find_file(Files& files, const FileName& name);

}  // namespace panwright::importers
