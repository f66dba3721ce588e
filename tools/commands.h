// The subcommands. Each stands in a file of its own name, command_….cpp, with its options.
#pragma once

#include <string>

#include "tools/command.h"

namespace panwright::tools {

Command new_command();
Command compile_command();
Command import_command();
Command export_command();
Command check_command();
Command info_command();
Command joints_command();
Command render_command();
Command view_command();
Command material_command();
Command mli_command();
Command diff_command();
Command fmt_command();
Command upgrade_command();
Command expand_command();
Command explain_command();
Command help_command();
Command version_command();
Command completion_command();

// Programs of other names that do one thing: pxntopan and pxn2pan, vrmltopan and gltftopan.
Command converter_command(const std::string& name);
Command importer_command(const std::string& name);

// For completion scripts: not in the table.
Command complete_command();

}  // namespace panwright::tools
