#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/completion.h"
#include "tools/print.h"

namespace panwright::tools {

namespace command_completion {
namespace {

struct Options {
  CommonOptions common;
  std::string shell = "bash";
  std::vector<std::string> words;  // of `complete`
};

void declare_script(Arguments& arguments, Options& options) {
  arguments.add("shell", options.shell, "Shell: bash (default), zsh or fish")
      .one_of({"bash", "zsh", "fish"})
      .type("SHELL");
  declare(arguments, options.common);
}

int print_script(const Options& options, const Host& host) {
  CommandContext context("completion", options.common, host);
  const std::string script = completion_script(options.shell);
  context.result()["shell"] = options.shell;
  context.result()["script"] = script;
  if (!options.common.json) print("{}", script);
  return context.finish();
}

// The words are a part of another line: none of them is an option of this command, and empty ones
// are words too.
void declare_words(Arguments& arguments, Options& options) {
  arguments
      .add("words", options.words, "Words of the line up to the cursor, after the program's name")
      .type("WORD…")
      .may_be_empty();
}

int print_candidates(const Options& options, const Host& host) {
  CommandContext context("complete", options.common, host);
  const Candidates found = candidates(options.words, context.job());
  for (const Candidates::Word& word : found.words) {
    const std::string line = word.text + "\t" + word.help;
    if (line.find('\n') == std::string::npos) print("{}\n", line);
  }
  if (found.files) print(":files{}{}\n", found.extension.empty() ? "" : " ", found.extension);
  if (found.folders) print(":folders\n");
  return context.finish();
}

}  // namespace
}  // namespace command_completion

Command completion_command() {
  return command("completion", "Print a completion script for a shell",
                 command_completion::declare_script, command_completion::print_script);
}

Command complete_command() {
  return command("complete", "List candidates at the cursor, for completion scripts",
                 command_completion::declare_words, command_completion::print_candidates);
}

}  // namespace panwright::tools
