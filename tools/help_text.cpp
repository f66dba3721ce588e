#include "tools/help_text.h"

#include <fmt/core.h>

#include <algorithm>

#include "tools/words.h"

namespace panwright::tools {

namespace {

constexpr std::size_t kWidth = 100;  // of a terminal
constexpr std::size_t kColumn = 30;  // where explanations begin

// A name on the left, its explanation on the right, or below where the name is long.
void append_row(const std::string& name, const std::string& text, std::size_t column,
                std::string& out) {
  out += "  " + name;
  const std::size_t length = 2 + characters(name);
  out += length + 2 > column ? "\n" + std::string(column, ' ') : std::string(column - length, ' ');
  out += wrapped(text, kWidth, column) + "\n";
}

}  // namespace

std::string usage_line(const DescribedCommand& command, const std::string& program) {
  std::string out = program;
  std::string arguments;
  bool options = false;
  for (const Option& option : command.arguments->options()) {
    if (option.argument)
      arguments += option.required ? " " + option.type : " [" + option.type + "]";
    else if (option.required)
      arguments += fmt::format(" {} {}", option.names.front(), option.type);
    else
      options = true;
  }
  return out + (options ? " [OPTIONS]" : "") + arguments;
}

std::string option_words(const Option& option) {
  std::string out;
  for (const std::string& name : option.names) out += (out.empty() ? "" : ", ") + name;
  return option.type.empty() ? out : out + " " + option.type;
}

std::vector<OptionGroup> option_groups(const Arguments& arguments) {
  std::vector<OptionGroup> groups;
  for (const Option& option : arguments.options()) {
    if (option.argument) continue;
    const std::string name = option.group.empty() ? "Options" : option.group;
    auto at = std::find_if(groups.begin(), groups.end(),
                           [&](const OptionGroup& group) { return group.name == name; });
    if (at == groups.end()) at = groups.insert(groups.end(), OptionGroup{name, {}});
    at->options.push_back(&option);
  }
  return groups;
}

std::string exit_code_words() {
  return "0 success, 1 errors in a model or not enough memory (diff: models differ; fmt --check: "
         "files "
         "would change), 2 wrong usage, 3 input or output error, 4 damaged pan file, 70 internal "
         "error, 130 stopped "
         "by Ctrl-C (143, 129 by SIGTERM, SIGHUP)";
}

std::string program_help(std::span<const DescribedCommand> table) {
  std::string out =
      "panwright: spacecraft models from pxn text and CAD files to checked pan files and "
      "radiometric images\n\n"
      "Usage: panwright COMMAND [OPTIONS] …\n\nCommands:\n";
  for (const DescribedCommand& each : table)
    append_row(each.command.name, each.command.help, 16, out);
  out += "\nExamples, from a copy of the folder examples/:\n";
  for (const char* name : {"compile", "render", "import"})
    for (const DescribedCommand& each : table)
      if (each.command.name == name && each.examples.size() > 1)
        out +=
            fmt::format("  panwright {} {}\n", name, each.examples[name[0] == 'r' ? 0 : 1].words);
  out += "\n" + wrapped("Exit codes: " + exit_code_words() + ".", kWidth, 0) + "\n\n";
  out +=
      "`panwright help COMMAND` lists the options of a command, `panwright explain CODE` explains "
      "a\ndiagnostic. The language: docs/pxn-reference.md. Cameras, axes, units and JSON output: "
      "\ndocs/conventions.md, docs/json-output.md.\n";
  return out;
}

std::string command_help(const DescribedCommand& command, const std::string& program) {
  std::string out = fmt::format("{}: {}\n\nUsage: {}\n", program, command.command.help,
                                usage_line(command, program));
  bool arguments = false;
  for (const Option& option : command.arguments->options()) {
    if (!option.argument) continue;
    if (!arguments) out += "\nArguments:\n";
    arguments = true;
    append_row(option.type, option.help, kColumn, out);
  }
  for (const OptionGroup& group : option_groups(*command.arguments)) {
    out += fmt::format("\n{}:\n", group.name);
    for (const Option* option : group.options)
      append_row(option_words(*option), option->help, kColumn, out);
  }
  append_row("-h, --help", "Show this help", kColumn, out);
  if (!command.examples.empty()) out += "\nExamples, from a copy of the folder examples/:\n";
  for (const Example& example : command.examples)
    out += fmt::format("  {}{}{}\n      {}\n", program, example.words.empty() ? "" : " ",
                       example.words, example.what);
  return out;
}

}  // namespace panwright::tools
