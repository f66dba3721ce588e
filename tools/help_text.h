// Help texts of the program, made from the table of commands.
#pragma once

#include <span>
#include <string>

#include "tools/command_table.h"

namespace panwright::tools {

// Returns "panwright render [OPTIONS] [NAME=]FILE…".
std::string usage_line(const DescribedCommand& command, const std::string& program);

// Returns the help of the program: its commands.
std::string program_help(std::span<const DescribedCommand> table);

// Returns the help of a command: usage, options by group, examples.
//
//   program  "panwright render", or the name of a program that is one command
std::string command_help(const DescribedCommand& command, const std::string& program);

// Options of a list, by group, in the order of their first declaration.
struct OptionGroup {
  std::string name;  // "Options"
  std::vector<const Option*> options;
};
std::vector<OptionGroup> option_groups(const Arguments& arguments);

// Returns "-o, --output FILE".
std::string option_words(const Option& option);

// Returns the exit codes in words, a line each.
std::string exit_code_words();

}  // namespace panwright::tools
