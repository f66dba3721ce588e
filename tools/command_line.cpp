// The command line: which command is meant, and what stands around all of them.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <new>

#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/completion.h"
#include "tools/print.h"
#include "tools/run.h"

namespace panwright::tools {

namespace {

constexpr int kUsage = 2;
constexpr int kUnwritten = 3;
constexpr int kInternal = 70;
constexpr int kCancelled = 130;

std::vector<Command> all_commands() {
  return {compile_command(), import_command(),  export_command(),   check_command(),
          info_command(),    render_command(),  material_command(), diff_command(),
          fmt_command(),     upgrade_command(), expand_command(),   explain_command()};
}

// Lets values begin with a minus sign: "--sun -1,0,0" and "--sun '-1 0 0'" become one word.
std::vector<std::string> joined_values(int argc, const char* const* argv) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    std::string word = argv[i];
    const bool negative = word.size() > 1 && word[0] == '-' &&
                          (std::isdigit(static_cast<unsigned char>(word[1])) || word[1] == '.');
    const bool after_option = !words.empty() && words.back().starts_with("--") &&
                              words.back().find('=') == std::string::npos &&
                              words.back().size() > 2;
    if (negative && after_option)
      words.back() += "=" + word;
    else if (word == "-lic")
      words.emplace_back("--lic");
    else
      words.push_back(std::move(word));
  }
  return words;
}

// --json promises one object on standard output, whatever happens.
int usage_error(const CLI::App& app, const CLI::ParseError& error, bool json) {
  if (!json) {
    app.exit(error);
    return kUsage;
  }
  const auto used = app.get_subcommands();
  CommonOptions common;
  common.json = true;
  CommandContext context(used.empty() ? app.get_name() : used[0]->get_name(), common, {});
  context.log().report(Code::E0201, {}, error.what());
  return context.finish();
}

int parse_and_run(CLI::App& app, std::vector<std::string> words, const std::function<int()>& go) {
  const bool json = std::find(words.begin(), words.end(), "--json") != words.end();
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  try {
    app.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    return usage_error(app, error, json);
  }
  return go();
}

// A program that is one command.
int run_single(const Command& command, std::vector<std::string> words, const Host& host) {
  CLI::App app(command.help, command.name);
  Arguments arguments(app);
  command.declare(arguments);
  return parse_and_run(app, std::move(words), [&] { return command.run(host); });
}

// Every command with its options, for completion scripts.
std::vector<CommandWords> command_words(const CLI::App& app) {
  std::vector<CommandWords> commands;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    CommandWords words{sub->get_name(), sub->get_description(), {}};
    for (const CLI::Option* option : sub->get_options())
      for (const std::string& name : option->get_lnames())
        words.options.push_back({"--" + name, option->get_description()});
    commands.push_back(std::move(words));
  }
  return commands;
}

int run_panwright(std::vector<std::string> words, const Host& host) {
  CLI::App app(
      "panwright: spacecraft models from pxn text and CAD files to checked pan files and "
      "radiometric "
      "pictures",
      "panwright");
  app.footer(
      "Examples:\n"
      "  panwright compile examples/paper/figure8.pxn -o f.pan\n"
      "  panwright render f.pan -o f.png --camera \"0 -5 1\" --sun \"1 -1 1\"\n"
      "  panwright import iss.glb -o iss.pxn\n"
      "  panwright explain E1101\n"
      "Exit codes: 0 ok, 1 errors in a model, 2 usage, 3 I/O, 4 damaged pan file, 70 internal, "
      "130 stopped by Ctrl-C (143, 129 by SIGTERM, SIGHUP).\n"
      "The language: docs/pxn-reference.md. Conventions of cameras, axes and units: "
      "docs/conventions.md.");
  app.require_subcommand(0, 1);
  bool version = false;
  bool json_version = false;
  app.add_flag("--version", version, "Print the version; with --json, the features too");
  app.add_flag("--json", json_version, "With --version: print JSON");
  const std::vector<Command> commands = all_commands();
  for (const Command& command : commands) {
    Arguments arguments(*app.add_subcommand(command.name, command.help));
    command.declare(arguments);
  }
  std::string shell = "bash";
  CLI::App* completion = app.add_subcommand("completion", "Print a shell completion script");
  Arguments(*completion)
      .add("shell", shell, "bash, zsh or fish")
      .one_of({"bash", "zsh", "fish"})
      .type("SHELL");
  return parse_and_run(app, std::move(words), [&]() -> int {
    if (version) return print_version(json_version);
    for (const Command& command : commands)
      if (app.got_subcommand(command.name)) return command.run(host);
    if (app.got_subcommand(completion)) {
      print("{}", completion_script(shell, command_words(app)));
      return 0;
    }
    print("{}", app.help());
    return kUsage;
  });
}

int run_unchecked(int argc, const char* const* argv, const Host& host) {
  try {
    const std::string name =
        argc > 0 ? std::filesystem::path(argv[0]).filename().string() : std::string("panwright");
    std::vector<std::string> words = joined_values(argc, argv);
    if (name == "pxntopan" || name == "pxn2pan")
      return run_single(converter_command(name), std::move(words), host);
    if (name == "vrmltopan" || name == "gltftopan")
      return run_single(importer_command(name), std::move(words), host);
    return run_panwright(std::move(words), host);
  } catch (const std::bad_alloc&) {
    print(stderr, "panwright: out of memory\n");
  } catch (const std::exception& error) {
    print(stderr, "panwright: internal error: {}\n", error.what());
  }
  return kInternal;
}

}  // namespace

int run(int argc, const char* const* argv, const Host& host) {
  const int code = run_unchecked(argc, argv, host);
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  print(stderr, "panwright: standard output could not be written\n");
  // the first of the order of exit_code(): what was stopped or asked for wrongly comes before
  return code == kUsage || code == kCancelled || code == kInternal ? code : kUnwritten;
}

}  // namespace panwright::tools
