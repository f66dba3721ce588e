#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "pxn/format.h"
#include "pxn/named_files.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"

namespace panwright::tools {

namespace command_fmt {
namespace {

struct Options {
  CommonOptions common;
  std::uint64_t max_input = 128ull << 20;  // bytes of each file
  std::vector<std::string> inputs;         // "-": standard input
  std::string output;                      // empty: each file itself; "-": standard output
  bool check = false;                      // write nothing, name the files that would change
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("inputs", options.inputs, "Files to format (-: standard input to standard output)")
      .required()
      .type("FILE.pxn…");
  arguments.flag("--check", options.check,
                 "Write nothing; name the files that would change, with exit code 1");
  arguments
      .add("-o,--output", options.output,
           "Output file (default: in place; -: standard output); for one input")
      .type("FILE");
  declare_max_input(arguments, options.max_input);
  declare(arguments, options.common);
}

class Formatting {
 public:
  Formatting(const Options& options, CommandContext& context)
      : options_(options), context_(context) {}

  void one(const std::string& input) {
    DiagnosticLog& log = context_.log();
    const bool standard = input == "-";
    const std::string name = standard ? "<standard input>" : input;
    context_.step("format " + name);
    auto bytes = read_file(standard ? "/dev/stdin" : input, options_.max_input, log);
    if (!bytes) return;
    const auto original = std::make_shared<const std::string>(std::move(*bytes));
    if (!standard) pxn::declare_named_files(input, *original, context_.files());
    pxn::Limits limits;
    limits.bytes = options_.max_input;
    const auto text = pxn::formatted(name, original, limits, log);
    if (!text) return;
    const bool changed = *text != *original;
    context_.result()["files"].push_back({{"file", name}, {"changed", changed}});
    any_changed_ = any_changed_ || changed;
    if (options_.check) {
      if (changed && !options_.common.json) print("{}\n", name);
      return;
    }
    const std::string output = options_.output.empty() ? input : options_.output;
    // a file that is as it should be keeps its time
    if (!changed && output == input && !standard) return;
    if (write_file(output, as_bytes(*text), log) && !standard) context_.wrote(output);
  }

  bool any_changed() const { return any_changed_; }

 private:
  const Options& options_;
  CommandContext& context_;
  bool any_changed_ = false;
};

int run(const Options& options, const Host& host) {
  CommandContext context("fmt", options.common, host);
  if (!options.output.empty() && (options.inputs.size() > 1 || options.check)) {
    context.log().report(Code("E0201"), {},
                         options.check
                             ? "-o cannot be combined with --check, which writes nothing"
                             : "-o requires a single file; several are formatted in place");
    return context.finish();
  }
  for (const std::string& input : options.inputs) context.files().will_read(input);
  // the sources stay what the program was asked to lay out
  if (!options.check)
    for (const std::string& output :
         options.output.empty() ? options.inputs : std::vector<std::string>{options.output})
      context.files().will_write(output, "", context.log(), FileUses::Output::in_place);
  if (context.log().has_errors()) return context.finish();
  Formatting formatting(options, context);
  for (const std::string& input : options.inputs) formatting.one(input);
  return context.finish(options.check && formatting.any_changed() ? 1 : 0);
}

}  // namespace
}  // namespace command_fmt

Command fmt_command() {
  return command("fmt", "Format pxn files in their canonical form; comments are kept",
                 command_fmt::declare_all, command_fmt::run);
}

}  // namespace panwright::tools
