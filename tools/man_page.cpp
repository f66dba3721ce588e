#include "tools/man_page.h"

#include <fmt/core.h>

#include "tools/help_text.h"

namespace panwright::tools {

namespace {

// Text of a line: hyphens stay hyphens that can be copied, and no line begins a request.
std::string plain(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool first = out.empty() || out.back() == '\n';
    if (first && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out.push_back(c);
  }
  return out;
}

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return out;
}

std::string page_head(const std::string& name, std::string_view help) {
  return fmt::format(".TH {} 1 \"\" \"panwright {}\" \"Panwright\"\n.SH NAME\n{} \\- {}\n",
                     upper(plain(name)), PANWRIGHT_VERSION, plain(name), plain(help));
}

void append_examples(const std::vector<Example>& examples, std::string& out) {
  for (const Example& example : examples)
    out += fmt::format(".TP\n.B panwright {} {}\n{}\n", example.command, plain(example.words),
                       plain(example.what));
}

}  // namespace

std::string program_man_page(std::span<const DescribedCommand> table) {
  std::string out = page_head("panwright", "spacecraft models from text and CAD files to images");
  out +=
      ".SH SYNOPSIS\n.B panwright\n.I COMMAND\n[\\fIOPTIONS\\fR] ...\n.SH DESCRIPTION\nCompiles "
      "spacecraft, written as pxn text or imported from CAD files, to checked pan files. Renders "
      "them as float radiance images, with ground truth and error estimates.\n.SH COMMANDS\n";
  for (const DescribedCommand& each : table)
    out += fmt::format(".TP\n.BR panwright\\-{} (1)\n{}\n", each.command.name,
                       plain(each.command.help));
  out += ".SH EXAMPLES\nFrom a copy of the folder examples:\n";
  for (const DescribedCommand& each : table)
    if (each.command.name == "compile" || each.command.name == "render")
      append_examples(each.examples, out);
  out += fmt::format(".SH EXIT STATUS\n{}.\n", plain(exit_code_words()));
  out +=
      ".SH ENVIRONMENT\n.TP\n.B NO_COLOR\nMessages have no colours.\n.TP\n.B PANWRIGHT_CACHE\noff: "
      "disables the cache.\n.TP\n.B XDG_CACHE_HOME\nThe folder of that cache.\n";
  return out;
}

std::string command_man_page(const DescribedCommand& command) {
  const std::string name = "panwright-" + command.command.name;
  const std::string program = "panwright " + command.command.name;
  std::string out = page_head(name, command.command.help);
  out += fmt::format(".SH SYNOPSIS\n.B {}\n{}\n", program,
                     plain(usage_line(command, program).substr(program.size() + 1)));
  bool arguments = false;
  for (const Option& option : command.arguments->options()) {
    if (!option.argument) continue;
    out += arguments ? "" : ".SH ARGUMENTS\n";
    arguments = true;
    out += fmt::format(".TP\n.I {}\n{}\n", plain(option.type), plain(option.help));
  }
  for (const OptionGroup& group : option_groups(*command.arguments)) {
    out += fmt::format(".SH {}\n", upper(plain(group.name)));
    for (const Option* option : group.options) {
      std::string names;
      for (const std::string& each : option->names)
        names += fmt::format("{}\\fB{}\\fR", names.empty() ? "" : ", ", plain(each));
      if (!option->type.empty()) names += fmt::format(" \\fI{}\\fR", plain(option->type));
      out += fmt::format(".TP\n{}\n{}\n", names, plain(option->help));
    }
  }
  out += ".SH EXAMPLES\nFrom a copy of the folder examples:\n";
  append_examples(command.examples, out);
  return out + ".SH SEE ALSO\n.BR panwright (1)\n";
}

}  // namespace panwright::tools
