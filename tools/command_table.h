// Table of all commands with their options and examples, source of the program, its help, its
// manual pages and the completion of shells.
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

// Declares the options of a command.
DescribedCommand described(Command command);

// Returns the commands in the order of the help.
std::vector<DescribedCommand> command_table();

// Returns a command; nullptr: unknown.
DescribedCommand* find_command(std::span<DescribedCommand> table, std::string_view name);

// Returns "'compil' is not a command; did you mean 'compile'?"
std::string unknown_command_words(std::string_view name, std::span<const DescribedCommand> table);

// Returns three examples of each command. They run from a copy of the project's folder examples/,
// in their order, each command's in a copy of its own; later ones of a command read the outputs of
// earlier ones.
std::span<const Example> all_examples();

}  // namespace panwright::tools
