// Subcommands, each in a file command_NAME.cpp with its options.
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
Command scenario_command();
Command run_command();
Command serve_command();
Command labels_command();
Command dataset_command();
Command stars_command();
Command lookup_command();
Command lidar_command();
Command radar_command();
Command camera_command();
Command dem_command();
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

// Makes the single-purpose programs: pxntopan and pxn2pan, vrmltopan and gltftopan.
Command converter_command(const std::string& name);
Command importer_command(const std::string& name);

// Makes the command of completion scripts, which is not in the table.
Command complete_command();

}  // namespace panwright::tools
