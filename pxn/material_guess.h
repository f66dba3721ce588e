// Guess of the library's material for a CAD material, if name and colour agree.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "importers/import.h"

namespace panwright::pxn {

// Inputs of a guess.
struct GuessInput {
  std::string_view name;    // as in the file
  Vec3 color{0.8};          // linear; the mean over a texture
  double metallic = 0;      // 0 to 1
  bool color_known = true;  // false: of an unreadable texture
};

// A preset and the reason for it, or the reason why the material stays as imported.
struct Guess {
  std::string_view preset;  // of the library; empty: as imported
  std::string reason;  // "'foil' and 'gold' in its name, and its colour"; a phrase, no sentence
};

// Guesses a preset. It needs a material in the name, found at word boundaries, and a possible
// colour of that material. A colour alone, or a colour word alone, does not suffice.
Guess guessed_preset(const GuessInput& input);

// Returns the words of a name in lower case: runs of letters, cut at other characters, at digits,
// before a capital after a small letter, and at the end of a run of capitals ("SolarPanel11",
// "MLIBlanket").
std::vector<std::string> words_of(std::string_view name);

// Returns the colour of material `index` of a file: its base colour, times the mean of its texture.
//
// Expects: index < imported.materials.size(). Cost: O(pixels of the texture).
GuessInput guess_input(const importers::Imported& imported, std::size_t index);

}  // namespace panwright::pxn
