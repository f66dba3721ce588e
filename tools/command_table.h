// All commands with their options and examples: what the program runs, and what its help, its
// manual pages and the completion of shells are made of.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "tools/arguments.h"
#include "tools/command.h"

namespace panwright::tools {

struct DescribedCommand {
  Command command;
  std::unique_ptr<Arguments> arguments;  // declared
  std::vector<Example> examples;
};

// A command with its options declared.
DescribedCommand described(Command command);

// In the order of the help.
std::vector<DescribedCommand> command_table();

// nullptr: no command is called that.
DescribedCommand* find_command(std::span<DescribedCommand> table, std::string_view name);

// "'compil' is not a command; did you mean 'compile'?"
std::string unknown_command_words(std::string_view name, std::span<const DescribedCommand> table);

// Three of each command. They run from a copy of the folder examples/ of the project, in their
// order, each command's in a copy of its own; what one writes, the next ones of the command read.
std::span<const Example> all_examples();

}  // namespace panwright::tools
