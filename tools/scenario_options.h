// Options of commands that read scenarios.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "tools/arguments.h"
#include "workspace/scenario.h"

namespace panwright::tools {

struct ScenarioInput {
  std::string file;
  workspace::ScenarioOptions options;
  std::vector<std::string> at;  // seconds
  std::optional<double> every;  // seconds
  std::string numbers;          // "N..M"

  // Opens the scenario and chooses frames. Fails: as open_scenario(), frame_times(); E0201.
  struct Opened {
    workspace::Scenario scenario;
    std::vector<double> times;  // of frames, or their numbers in an order
    std::uint64_t first = 0;    // number of the first of them
  };
  Result<Opened> open(DiagnosticLog& log) const;
};
void declare(Arguments& arguments, ScenarioInput& input);

}  // namespace panwright::tools
