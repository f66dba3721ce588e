#include "tools/completion.h"

#include <algorithm>
#include <cctype>

#include "mli/preset.h"
#include "pxn/materials.h"
#include "tools/command_table.h"
#include "workspace/open.h"
#include "workspace/targets.h"

namespace panwright::tools {

namespace {

using Words = std::vector<std::string>;

const Option* named(const Arguments& arguments, std::string_view name) {
  for (const Option& option : arguments.options())
    if (!option.argument &&
        std::find(option.names.begin(), option.names.end(), name) != option.names.end())
      return &option;
  return nullptr;
}

// "--size=64x64" as two words; a lone "=", which bash makes of it, is taken away.
struct TypedLine {
  Words words;
  std::string prefix;  // "--size=", of the last word; empty where bash cuts it off
};

TypedLine split(const Words& words) {
  TypedLine line;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool last = i + 1 == words.size();
    if (words[i] == "=" && !line.words.empty()) {
      if (last) line.words.emplace_back();
      continue;
    }
    const std::size_t sign = words[i].find('=');
    if (words[i].starts_with("--") && sign != std::string::npos) {
      line.words.push_back(words[i].substr(0, sign));
      line.words.push_back(words[i].substr(sign + 1));
      if (last) line.prefix = words[i].substr(0, sign + 1);
    } else {
      line.words.push_back(words[i]);
    }
  }
  return line;
}

class Completer {
 public:
  Completer(const Arguments& arguments, const Job& job) : arguments_(arguments), job_(job) {}

  // words: what follows the command.
  Candidates complete(const Words& words) {
    const Option* pending = nullptr;  // that waits for its value
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
      const std::string& word = words[i];
      if (pending != nullptr) {
        pending = nullptr;
      } else if (word.size() > 1 && word[0] == '-') {
        const Option* option = named(arguments_, word);
        if (option != nullptr && !option->is_flag()) pending = option;
      } else {
        given_.push_back(word);
      }
    }
    if (pending != nullptr) return values(*pending);
    if (words.back().starts_with('-')) return options();
    std::size_t left = given_.size();
    for (const Option& option : arguments_.options())
      if (option.argument && (option.repeatable || left-- == 0)) return values(option);
    return options();
  }

 private:
  Candidates options() const {
    Candidates out;
    for (const Option& option : arguments_.options())
      if (!option.argument) out.words.push_back({option.name(), option.help});
    out.words.push_back({"--help", "Show options and examples"});
    return out;
  }

  // What an option takes is told by the name of its value.
  Candidates values(const Option& option) {
    Candidates out;
    const auto says = [&](const char* word) { return option.type.find(word) != std::string::npos; };
    for (const std::string& choice : option.choices) out.words.push_back({choice, {}});
    if (!out.words.empty()) return out;
    if (says("PRESET"))
      for (const std::string_view name : pxn::preset_names())
        out.words.push_back({std::string(name), "material of the library"});
    if (says("SHEET"))
      for (const mli::Preset& preset : mli::presets())
        out.words.push_back({std::string(preset.name), "sheet of foil"});
    if (says("FRAME")) add_frames(out);
    if (option.type == "NAME") add_materials(out);
    if (says("CODE"))
      for (const CodeInfo& info : all_codes())
        out.words.push_back({std::string(info.name), std::string(info.title)});
    if (says("COMMAND"))
      for (const DescribedCommand& each : command_table())
        out.words.push_back({each.command.name, each.command.help});
    out.folders = says("DIR") || says("FOLDER");
    out.files = says("FILE") || says("OUT") || says("TABLE") || option.argument;
    if (!out.words.empty() && !says("FILE")) out.files = false;
    for (const char* extension : {".pxn", ".pan", ".json", ".glb"})
      if (option.type.starts_with(std::string("FILE") + extension)) out.extension = extension;
    return out;
  }

  void add_frames(Candidates& out) const {
    for (const std::string& text : given_) {
      const workspace::TargetFile target = workspace::target_file(text);
      DiagnosticLog log;
      workspace::OpenOptions read;
      read.prune = false;
      const auto model = workspace::open(target.file, read, log, job_);
      if (!model) continue;
      for (std::size_t i = 0; i < (*model)->frames().size(); ++i) {
        std::string name((*model)->frame_name(i));
        if (given_.size() > 1) name = target.name + "/" + name;
        out.words.push_back({std::move(name), "frame of " + text});
      }
    }
  }

  void add_materials(Candidates& out) const {
    for (const std::string& file : given_) {
      if (workspace::extension_of(file) != ".pxn") continue;
      DiagnosticLog log;
      if (const auto found = pxn::read_materials(file, {}, log, job_))
        for (const pxn::DescribedMaterial& each : *found)
          out.words.push_back({each.material.name, "material of " + file});
    }
  }

  const Arguments& arguments_;
  const Job& job_;
  Words given_;  // arguments
};

}  // namespace

Candidates candidates(std::vector<std::string> words, const Job& job) {
  Candidates out;
  if (words.empty()) words.emplace_back();
  auto table = command_table();
  if (words.size() == 1) {
    for (const DescribedCommand& each : table)
      out.words.push_back({each.command.name, each.command.help});
    out.words.push_back({"--help", "List the commands"});
    out.words.push_back({"--version", "Print the version"});
  } else if (const DescribedCommand* command = find_command(table, words[0])) {
    const TypedLine line = split({words.begin() + 1, words.end()});
    out = Completer(*command->arguments, job).complete(line.words);
    for (Candidates::Word& word : out.words) word.text.insert(0, line.prefix);
    const std::string last = line.prefix + line.words.back();
    std::erase_if(out.words, [&](const auto& word) { return !word.text.starts_with(last); });
    return out;
  }
  std::erase_if(out.words, [&](const auto& word) { return !word.text.starts_with(words.back()); });
  return out;
}

std::string completion_script(std::string_view shell) {
  if (shell == "zsh")
    return R"(#compdef panwright
# zsh completion of panwright: a file _panwright in a folder of fpath
_panwright() {
  local line text help
  local -a shown
  while IFS= read -r line; do
    text=${line%%$'\t'*} help=${line#*$'\t'}
    case $line in
      :files) _files ;;
      :files\ *) _files -g "*${line#:files }" ;;
      :folders) _files -/ ;;
      *) shown+=("${text//:/\\:}:$help") ;;
    esac
  done < <("$words[1]" complete -- "${(@)words[2,CURRENT]}" 2>/dev/null)
  (( $#shown )) && _describe panwright shown
}
compdef _panwright panwright
)";
  if (shell == "fish")
    return R"(# fish completion of panwright: panwright.fish in a folder of fish_complete_path
function __panwright_candidates
  set -l words (commandline -opc)
  set -l last (commandline -ct)
  for line in ($words[1] complete -- $words[2..-1] "$last" 2>/dev/null)
    switch $line
      case ':folders'
        __fish_complete_directories "$last"
      case ':files*'
        __fish_complete_path "$last"
      case '*'
        echo $line
    end
  end
end
complete -c panwright -f -a '(__panwright_candidates)'
)";
  return R"(# bash completion of panwright: source it, or install it as panwright in bash_completion.d
_panwright() {
  local word="${COMP_WORDS[COMP_CWORD]}" line
  COMPREPLY=()
  [ "$word" = "=" ] && word=""
  while IFS= read -r line; do
    case "$line" in
      :files) COMPREPLY+=($(compgen -f -- "$word")) ;;
      ":files "*) COMPREPLY+=($(compgen -d -- "$word") $(compgen -f -X "!*${line#:files }" -- "$word")) ;;
      :folders) COMPREPLY+=($(compgen -d -- "$word")) ;;
      *) COMPREPLY+=("${line%%$'\t'*}") ;;
    esac
  done < <("${COMP_WORDS[0]}" complete -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
}
complete -o filenames -F _panwright panwright
)";
}

}  // namespace panwright::tools
