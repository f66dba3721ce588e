// Values of settings' texts as JSON. Private to workspace.
#pragma once

#include <nlohmann/json.hpp>

#include "base/config_text.h"

namespace panwright::workspace {

// Returns a value as JSON; whole numbers are integers.
nlohmann::json config_json(const ConfigValue& value);

}  // namespace panwright::workspace
