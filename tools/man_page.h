// Manual pages, made from the table of commands.
#pragma once

#include <span>
#include <string>

#include "tools/command_table.h"

namespace panwright::tools {

// Returns panwright(1), in the macros of man(7).
std::string program_man_page(std::span<const DescribedCommand> table);

// Returns panwright-COMMAND(1).
std::string command_man_page(const DescribedCommand& command);

}  // namespace panwright::tools
