// Completion of command lines in shells. The scripts query the program, which answers from the
// table of commands, the library of materials and the files of the line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/job.h"

namespace panwright::tools {

// Returns a script for "bash", "zsh" or "fish".
std::string completion_script(std::string_view shell);

// Completions at the cursor.
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

// Returns the candidates for the last word, which may be empty, of those after "panwright". "=" may
// be a word of its own, as in bash: candidates are then values without their option.
Candidates candidates(std::vector<std::string> words, const Job& job);

}  // namespace panwright::tools
