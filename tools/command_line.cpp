// The command line: which command is meant, and what stands around all of them.

#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <span>

#include "base/text.h"
#include "tools/command_context.h"
#include "tools/command_table.h"
#include "tools/commands.h"
#include "tools/help_text.h"
#include "tools/print.h"
#include "tools/run.h"

namespace panwright::tools {

namespace {

constexpr int kUsage = 2;
constexpr int kUnwritten = 3;
constexpr int kInternal = 70;
constexpr int kCancelled = 130;

// --json promises one object on standard output, whatever happens.
CommandContext context_of(const std::string& command, const std::vector<std::string>& words) {
  CommonOptions common;
  common.json = std::find(words.begin(), words.end(), "--json") != words.end();
  return {command, common, {}};
}

int usage_error(const std::string& command, std::string message,
                const std::vector<std::string>& words) {
  CommandContext context = context_of(command, words);
  context.log().report(Code("E0201"), {}, std::move(message));
  return context.finish();
}

bool asks_for_help(const std::vector<std::string>& words) {
  const auto end = std::find(words.begin(), words.end(), "--");
  return std::any_of(words.begin(), end,
                     [](const std::string& word) { return word == "--help" || word == "-h"; });
}

// program: what was typed to call the command, "panwright render" or "pxntopan".
int run_command(DescribedCommand& command, const std::string& program,
                const std::vector<std::string>& words, const Host& host) {
  if (asks_for_help(words)) {
    print("{}", command_help(command, program));
    return 0;
  }
  if (auto error = command.arguments->parse(program, words))
    return usage_error(command.command.name, std::move(error->message), words);
  try {
    return command.command.run(host);
  } catch (const std::exception&) {
    CommandContext context = context_of(command.command.name, words);
    report_exception(context.log());
    return context.finish();
  }
}

// A program that is one command.
int run_single(Command command, std::vector<std::string> words, const Host& host) {
  // licences of the original tools have an option of one hyphen
  std::replace(words.begin(), words.end(), std::string("-lic"), std::string("--lic"));
  const std::string name = command.name;
  DescribedCommand single = described(std::move(command));
  return run_command(single, name, words, host);
}

// "panwright --version --json" and the like.
int run_without_command(const std::vector<std::string>& words, std::span<DescribedCommand> table,
                        const Host& host) {
  if (asks_for_help(words)) {
    print("{}", program_help(table));
    return 0;
  }
  std::vector<std::string> rest;
  for (const std::string& word : words)
    if (word != "--version") rest.push_back(word);
  if (rest.size() < words.size())
    return run_command(*find_command(table, "version"), "panwright --version", rest, host);
  for (const std::string& word : words)
    if (find_command(table, word) != nullptr)
      return usage_error("usage",
                         fmt::format("{} precedes the command, expected `panwright {} {} …`",
                                     in_quotes(words[0]), word, words[0]),
                         words);
  constexpr std::string_view kOptions[] = {"--help", "--version"};
  const auto near = nearest_name(words[0], kOptions);
  return usage_error("usage",
                     fmt::format("{} is not an option of 'panwright'; {}", in_quotes(words[0]),
                                 near ? fmt::format("did you mean '{}'?", *near)
                                      : std::string("expected a command, --help or --version")),
                     words);
}

int run_panwright(const std::vector<std::string>& words, const Host& host) {
  auto table = command_table();
  if (words.empty()) {
    print("{}", program_help(table));
    return kUsage;
  }
  if (words[0].starts_with('-')) return run_without_command(words, table, host);
  const std::vector<std::string> rest(words.begin() + 1, words.end());
  if (words[0] == "complete") {
    DescribedCommand complete = described(complete_command());
    return run_command(complete, "panwright complete", rest, host);
  }
  if (DescribedCommand* command = find_command(table, words[0]))
    return run_command(*command, "panwright " + words[0], rest, host);
  return usage_error("usage", unknown_command_words(words[0], table), words);
}

int run_unchecked(int argc, const char* const* argv, const Host& host) {
  try {
    const std::string name =
        argc > 0 ? std::filesystem::path(argv[0]).filename().string() : std::string("panwright");
    std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (name == "pxntopan" || name == "pxn2pan")
      return run_single(converter_command(name), std::move(words), host);
    if (name == "vrmltopan" || name == "gltftopan")
      return run_single(importer_command(name), std::move(words), host);
    return run_panwright(words, host);
  } catch (const std::exception&) {
    DiagnosticLog log;
    report_exception(log);
    print(stderr, "{}", to_text(log));
    return exit_code(log);
  }
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
