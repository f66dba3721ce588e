// A first pxn text around a CAD file: the import, and a material of the library for each of its
// own.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "importers/import.h"

namespace panwright::pxn {

// The library's material that a CAD material most likely stands for.
struct Guess {
  std::string_view preset;
  std::string reason;        // "'foil' in its name", "its colour"
  bool keeps_color = false;  // a paint: the diffuse colour stays the CAD file's
};

// By words of the name first, then by colour and metalness. Never empty.
Guess guessed_preset(const importers::CadMaterial& material);

// Names that tell CAD materials apart, as <assign> and <remove> take them: the second "foil" is
// "foil#2", the k-th without a name "#k".
std::vector<std::string> numbered_names(std::span<const importers::CadMaterial> materials);

// The text of a model that imports `file`: one <material> and one <assign> for each CAD material
// that something wears, by its name or, as "#2", its number, guesses explained in comments, and the
// joints that were found as a comment. attributes: of the import, as they are to be written ("
// units=\"mm\""), may be empty.
std::string import_template(const importers::Imported& imported, std::string_view file,
                            std::string_view attributes);

}  // namespace panwright::pxn
