// Shell completion scripts.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace panwright::tools {

struct OptionWords {
  std::string name;  // "--output"
  std::string help;
};

struct CommandWords {
  std::string name;
  std::string help;
  std::vector<OptionWords> options;
};

// A script for bash, zsh or fish that completes commands, options and file names.
std::string completion_script(std::string_view shell, const std::vector<CommandWords>& commands);

}  // namespace panwright::tools
