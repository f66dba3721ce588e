#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "tools/command_context.h"
#include "tools/command_table.h"
#include "tools/commands.h"
#include "tools/help_text.h"
#include "tools/man_page.h"
#include "tools/print.h"

namespace panwright::tools {

namespace help_command_parts {
namespace {

struct Options {
  CommonOptions common;
  std::string command;  // empty: the program
  bool man = false;
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("command", options.command, "Command, as render (default: lists all)")
      .type("COMMAND");
  arguments.flag("--man", options.man, "Print the manual page instead, for man -l -");
  declare(arguments, options.common);
}

nlohmann::ordered_json as_json(const Option& option) {
  nlohmann::ordered_json out{{"names", option.names}, {"help", option.help}};
  out["value"] =
      option.is_flag() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(option.type);
  out["choices"] = option.choices;
  out["argument"] = option.argument;
  out["required"] = option.required;
  out["repeatable"] = option.repeatable;
  out["group"] = option.group;
  return out;
}

nlohmann::ordered_json as_json(const DescribedCommand& command) {
  nlohmann::ordered_json out{{"name", command.command.name}, {"help", command.command.help}};
  out["options"] = nlohmann::ordered_json::array();
  for (const Option& option : command.arguments->options())
    out["options"].push_back(as_json(option));
  out["examples"] = nlohmann::ordered_json::array();
  for (const Example& example : command.examples)
    out["examples"].push_back(
        {{"words", fmt::format("panwright {} {}", example.command, example.words)},
         {"what", example.what}});
  return out;
}

int run(const Options& options, const Host& host) {
  CommandContext context("help", options.common, host);
  auto table = command_table();
  nlohmann::ordered_json& out = context.result();
  out["commands"] = nlohmann::ordered_json::array();
  if (options.command.empty()) {
    for (const DescribedCommand& each : table) out["commands"].push_back(as_json(each));
    if (!options.common.json)
      print("{}", options.man ? program_man_page(table) : program_help(table));
    return context.finish();
  }
  const DescribedCommand* command = find_command(table, options.command);
  if (command == nullptr) {
    context.log().report(Code("E0201"), {}, unknown_command_words(options.command, table));
    return context.finish();
  }
  out["commands"].push_back(as_json(*command));
  if (!options.common.json)
    print("{}", options.man ? command_man_page(*command)
                            : command_help(*command, "panwright " + command->command.name));
  return context.finish();
}

}  // namespace
}  // namespace help_command_parts

Command help_command() {
  return command("help", "List the commands, or the options of one",
                 help_command_parts::declare_all, help_command_parts::run);
}

}  // namespace panwright::tools
