// A first pxn text around a CAD file: the import, and materials of the library where name and
// colour say one (pxn/material_guess.h).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "importers/import.h"

namespace panwright::pxn {

// Names that tell CAD materials apart, as <assign> and <remove> take them: the second "foil" is
// "foil#2", the k-th without a name "#k".
std::vector<std::string> numbered_names(std::span<const importers::CadMaterial> materials);

// The text of a model that imports `file`: a <material> and an <assign> for each CAD material in
// use that has a guess, by its name or, as "#2", its number; a comment for each of them and for
// each that stays as imported, with name, colour and reason; and the joints that were found as a
// comment. attributes: of the import, as they are to be written (" units=\"mm\""), may be empty.
std::string import_template(const importers::Imported& imported, std::string_view file,
                            std::string_view attributes);

// A text as the value of an attribute in double quotes.
std::string attribute_value(std::string_view text);

}  // namespace panwright::pxn
