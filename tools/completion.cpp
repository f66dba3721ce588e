#include "tools/completion.h"

#include <fmt/format.h>

namespace panwright::tools {

namespace {

std::string joined(const std::vector<OptionWords>& options) {
  std::string out;
  for (const OptionWords& option : options) out += (out.empty() ? "" : " ") + option.name;
  return out;
}

// Text inside single quotes of a shell; square brackets and colons have a meaning in zsh.
std::string plain(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'')
      out += "'\\''";
    else if (c == '[' || c == ']')
      out += c == '[' ? '(' : ')';
    else if (c == ':')
      out += "\\:";
    else
      out.push_back(c);
  }
  return out;
}

std::string bash(const std::vector<CommandWords>& commands) {
  std::string names, cases;
  for (const CommandWords& command : commands) {
    names += (names.empty() ? "" : " ") + command.name;
    cases +=
        fmt::format("    {}) options=\"{} --help\" ;;\n", command.name, joined(command.options));
  }
  return fmt::format(
      "# bash completion of panwright: source it, or install it as panwright in bash_completion.d\n"
      "_panwright() {{\n"
      "  local word=\"${{COMP_WORDS[COMP_CWORD]}}\" options=\"\"\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    COMPREPLY=($(compgen -W \"{} --help --version\" -- \"$word\"))\n"
      "    return\n"
      "  fi\n"
      "  case \"${{COMP_WORDS[1]}}\" in\n{}  esac\n"
      "  case \"$word\" in\n"
      "    -*) COMPREPLY=($(compgen -W \"$options\" -- \"$word\")) ;;\n"
      "    *) COMPREPLY=($(compgen -f -- \"$word\")) ;;\n"
      "  esac\n"
      "}}\n"
      "complete -o filenames -F _panwright panwright\n",
      names, cases);
}

std::string zsh(const std::vector<CommandWords>& commands) {
  std::string names, cases;
  for (const CommandWords& command : commands) {
    names += fmt::format("    '{}:{}'\n", command.name, plain(command.help));
    cases += fmt::format("    {}) _arguments", command.name);
    for (const OptionWords& option : command.options)
      cases += fmt::format(" '{}[{}]'", option.name, plain(option.help));
    cases += " '*:file:_files' ;;\n";
  }
  return fmt::format(
      "#compdef panwright\n"
      "_panwright() {{\n"
      "  local -a commands=(\n{}  )\n"
      "  if (( CURRENT == 2 )); then _describe command commands; return; fi\n"
      "  local command=$words[2]\n"
      "  shift words; (( CURRENT-- ))\n"
      "  case $command in\n{}  esac\n"
      "}}\n"
      "compdef _panwright panwright\n",
      names, cases);
}

std::string fish(const std::vector<CommandWords>& commands) {
  std::string out;
  for (const CommandWords& command : commands) {
    out += fmt::format("complete -c panwright -n __fish_use_subcommand -a {} -d '{}'\n",
                       command.name, plain(command.help));
    for (const OptionWords& option : command.options)
      out +=
          fmt::format("complete -c panwright -n '__fish_seen_subcommand_from {}' -l {} -d '{}'\n",
                      command.name, option.name.substr(2), plain(option.help));
  }
  return out;
}

}  // namespace

std::string completion_script(std::string_view shell, const std::vector<CommandWords>& commands) {
  return shell == "zsh" ? zsh(commands) : shell == "fish" ? fish(commands) : bash(commands);
}

}  // namespace panwright::tools
