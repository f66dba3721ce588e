// Settings as JSON values. Private to workspace.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "workspace/settings.h"

namespace panwright::workspace {

// Reads a value of a JSON type that the setting has.
//
// Fails: E0201; settings stay. Reports: W1214.
bool read_setting(SettingId id, const nlohmann::json& value, Settings& settings,
                  DiagnosticLog& log);

// Returns the words after "has the wrong type": the part of the value and what it is; empty: the
// value has a type of the setting.
std::string wrong_type(SettingId id, const nlohmann::json& value);

// Returns a value that reads back to the same bits.
nlohmann::ordered_json setting_json(SettingId id, const Settings& settings);

}  // namespace panwright::workspace
