// Settings of an image: reading, printing, defaults, rules. Made from schemas/views.toml.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "workspace/generated/settings_table.h"

namespace panwright::workspace {

constexpr const SettingInfo& info_of(SettingId id) {
  return kSettings[static_cast<std::size_t>(id)];
}

// Reads a value as typed on a command line. Poses ("NAME=X Y Z QW QX QY QZ"), joints
// ("JOINT=VALUE") and files are added to those before.
//
// Fails: E0201; settings stay. Reports: W1214.
bool read_setting(SettingId id, std::string_view text, Settings& settings, DiagnosticLog& log);

// Returns a value as typed on a command line, which reads back to the same bits.
std::string setting_text(SettingId id, const Settings& settings);
// Returns all values of a setting that is given: those of poses and joints one by one.
std::vector<std::string> setting_texts(SettingId id, const Settings& settings);

// Returns settings completed by defaults. What contradicts them in the defaults is left out.
Settings with_defaults(Settings own, const Settings& defaults);

// Returns settings with the values of presets (`quality`) in place of defaults.
Settings with_presets(Settings settings);

// Returns true for a value that is given or of a preset, or for one other than the default.
bool has_value(SettingId id, const Settings& settings);
bool is_changed(SettingId id, const Settings& settings);

// Returns true if a setting has an effect beside the others.
bool is_effective(SettingId id, const Settings& settings);

// Returns a quaternion of unit length to 1e-3 as one of unit length; none: another. One that is
// unit to a few roundings stays.
std::optional<Quat> unit_quaternion(const Quat& q);

// Checks bounds and the rules of schemas/views.toml. Fails: E0201.
bool check(const Settings& settings, DiagnosticLog& log);

}  // namespace panwright::workspace
