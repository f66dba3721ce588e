// Values of settings' texts as JSON, and what several such texts have. Private to workspace.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "base/config_text.h"
#include "labels/parts.h"

namespace panwright::workspace {

// Returns a value as JSON; whole numbers are integers.
nlohmann::json config_json(const ConfigValue& value);

// Reads `parts` of a table of labels: nodes, or lists of them, by label. Problems are the table's.
void read_label_parts(ConfigTable& part, std::vector<labels::ChosenPart>& parts);

}  // namespace panwright::workspace
