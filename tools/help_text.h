// What the program says of itself, made of the table of commands.
#pragma once

#include <span>
#include <string>

#include "tools/command_table.h"

namespace panwright::tools {

// "panwright render [OPTIONS] [NAME=]FILE…"
std::string usage_line(const DescribedCommand& command, const std::string& program);

// The help of the program: its commands.
std::string program_help(std::span<const DescribedCommand> table);

// The help of a command: usage, options by group, examples.
//
//   program  "panwright render", or the name of a program that is one command
std::string command_help(const DescribedCommand& command, const std::string& program);

// The options that a list shows, by group, in the order of their first declaration.
struct OptionGroup {
  std::string name;  // "Options"
  std::vector<const Option*> options;
};
std::vector<OptionGroup> option_groups(const Arguments& arguments);

// "-o, --output FILE"
std::string option_words(const Option& option);

// The exit codes in words, a line each.
std::string exit_code_words();

}  // namespace panwright::tools
