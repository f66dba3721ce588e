// Reader of the instruments of a scenario. Private to workspace.
#pragma once

#include <filesystem>
#include <vector>

#include "base/config_text.h"
#include "workspace/scenario_instrument.h"

namespace panwright::workspace {

// Reads `instrument` of a scenario. False: a problem, which is reported.
//
//   folder  of the scenario
bool read_instruments(ConfigTable& scenario, const std::filesystem::path& folder,
                      std::vector<ScenarioInstrument>& instruments, DiagnosticLog& log);

}  // namespace panwright::workspace
