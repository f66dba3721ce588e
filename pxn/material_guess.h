// The library's material that a CAD material stands for, where name and colour agree on one.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "importers/import.h"

namespace panwright::pxn {

// What a guess looks at.
struct GuessInput {
  std::string_view name;    // as in the file
  Vec3 color{0.8};          // linear; the mean over the texture where there is one
  double metallic = 0;      // 0 to 1
  bool color_known = true;  // false: of a texture that could not be read
};

// A preset and the reason for it, or the reason why the material stays as imported.
struct Guess {
  std::string_view preset;  // of the library; empty: as imported
  std::string reason;  // "'foil' and 'gold' in its name, and its colour"; a phrase, no sentence
};

// A guess needs a material in the name, found at word boundaries, and a colour that this material
// can have. A colour alone, or a colour word alone, is no material.
Guess guessed_preset(const GuessInput& input);

// The words of a name in lower case: runs of letters, cut at other characters, at digits, and where
// a small letter meets a capital or a run of capitals ends ("SolarPanel11", "MLIBlanket").
std::vector<std::string> words_of(std::string_view name);

// The colour of material `index` of a file: its base colour, times the mean of its texture.
//
// Expects: index < imported.materials.size(). Cost: O(pixels of the texture).
GuessInput guess_input(const importers::Imported& imported, std::size_t index);

}  // namespace panwright::pxn
