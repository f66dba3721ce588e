// Completion of command lines in shells. The scripts ask the program: what it answers comes from
// the table of commands, the library of materials and the files that the line names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/job.h"

namespace panwright::tools {

// A script for "bash", "zsh" or "fish".
std::string completion_script(std::string_view shell);

// What may stand where the cursor is.
struct Candidates {
  struct Word {
    std::string text;
    std::string help;  // one line; may be empty
  };
  std::vector<Word> words;
  bool files = false;
  bool folders = false;
  std::string extension;  // of the files, ".pxn"; empty: any
};

// The candidates for the last word, which may be empty, of those that follow "panwright". "=" may
// be a word of its own, as bash has it: candidates are then values without their option.
Candidates candidates(std::vector<std::string> words, const Job& job);

}  // namespace panwright::tools
