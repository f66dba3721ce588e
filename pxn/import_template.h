// Template of a pxn text around a CAD file: the import, and materials of the library by name and
// colour (pxn/material_guess.h).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "importers/import.h"

namespace panwright::pxn {

// Returns unique names of CAD materials, as in <assign> and <remove>: the second "foil" is
// "foil#2", the k-th without a name "#k".
std::vector<std::string> numbered_names(std::span<const importers::CadMaterial> materials);

// Writes a model that imports `file`: a <material> and an <assign> for each guessed CAD material in
// use, by its name or, as "#2", its number. Comments give name, colour and reason of each guess and
// of each material kept as imported, and the found joints. attributes: of the import, as text ("
// units=\"mm\""), may be empty.
std::string import_template(const importers::Imported& imported, std::string_view file,
                            std::string_view attributes);

// Returns a text as an attribute value in double quotes.
std::string attribute_value(std::string_view text);

}  // namespace panwright::pxn
