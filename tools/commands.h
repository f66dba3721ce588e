// The subcommands: each does one job, reports, and returns the process's exit code.
#pragma once

#include "tools/options.h"

namespace panwright::tools {

int compile(const CompileOptions& options);
int import_cad(const ImportOptions& options);
int export_cad(const ExportOptions& options);
int check(const CheckOptions& options);
int info(const InfoOptions& options);
int render(const RenderOptions& options);
int material(const MaterialOptions& options);
int diff(const DiffOptions& options);
int format(const FmtOptions& options);
int upgrade(const UpgradeOptions& options);
int expand(const ExpandOptions& options);
int explain(const ExplainOptions& options);
int version(bool json);

}  // namespace panwright::tools
