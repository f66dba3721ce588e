#include "tools/command_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "base/diagnostic.h"
#include "base/text.h"
#include "tools/commands.h"

namespace panwright::tools {

DescribedCommand described(Command command) {
  DescribedCommand out{std::move(command), std::make_unique<Arguments>(), {}};
  out.command.declare(*out.arguments);
  for (const Example& example : all_examples())
    if (example.command == out.command.name) out.examples.push_back(example);
  return out;
}

std::vector<DescribedCommand> command_table() {
  std::vector<DescribedCommand> table;
  for (auto* make :
       {new_command,      compile_command, import_command, export_command,   check_command,
        info_command,     joints_command,  render_command, scenario_command, run_command,
        labels_command,   dataset_command, stars_command,  camera_command,   view_command,
        material_command, mli_command,     diff_command,   fmt_command,      upgrade_command,
        expand_command,   explain_command, help_command,   version_command,  completion_command})
    table.push_back(described(make()));
  return table;
}

DescribedCommand* find_command(std::span<DescribedCommand> table, std::string_view name) {
  const auto at = std::find_if(table.begin(), table.end(),
                               [&](const auto& each) { return each.command.name == name; });
  return at == table.end() ? nullptr : &*at;
}

std::string unknown_command_words(std::string_view name, std::span<const DescribedCommand> table) {
  std::vector<std::string_view> names;
  for (const DescribedCommand& each : table) names.push_back(each.command.name);
  if (const auto near = nearest_name(name, names))
    return fmt::format("{} is not a command; did you mean '{}'?", in_quotes(name), *near);
  std::error_code ignored;
  if (std::filesystem::exists(std::filesystem::path(name), ignored))
    return fmt::format("{} is a file, expected a command first, as in `panwright info {}`",
                       in_quotes(name), name);
  return fmt::format("{} is not a command; `panwright help` lists them", in_quotes(name));
}

}  // namespace panwright::tools
