// A first pxn text around a CAD file: the import, and a material of the library for each of its
// own.
#pragma once

#include <string>
#include <string_view>

#include "importers/import.h"

namespace panwright::pxn {

// The library's material that a CAD material most likely stands for.
struct Guess {
  std::string_view preset;
  std::string reason;         // "'foil' in its name", "its colour"
  bool keeps_colour = false;  // a paint: the diffuse colour stays the CAD file's
};

// By words of the name first, then by colour and metalness. Never empty.
Guess guessed_preset(const importers::CadMaterial& material);

// The text of a model that imports `file`: one <material> and one <assign> for each CAD material
// with a name that something wears, guesses explained in comments, and the joints that were found
// as a comment. attributes: of the import, as they are to be written (" units=\"mm\""), may be
// empty.
std::string skeleton(const importers::Imported& imported, std::string_view file,
                     std::string_view attributes);

}  // namespace panwright::pxn
