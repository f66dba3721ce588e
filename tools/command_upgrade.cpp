#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "pxn/upgrade.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"
#include "workspace/open.h"

namespace panwright::tools {

namespace command_upgrade {
namespace {

struct Options {
  CommonOptions common;
  std::string root;
  std::uint64_t max_input = 128ull << 20;  // bytes of a model
  std::vector<std::string> inputs;
  std::string output;  // empty: each file itself
};

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("inputs", options.inputs, "Files to upgrade: a model, and any of its included files")
      .required()
      .type("FILE.pxn…");
  arguments
      .add("-o,--output", options.output,
           "Output file (default: in place; -: standard output); for one input")
      .type("FILE");
  declare_root(arguments, options.root);
  declare_max_input(arguments, options.max_input);
  declare(arguments, options.common);
}

int run(const Options& options, const Host& host) {
  CommandContext context("upgrade", options.common, host);
  DiagnosticLog& log = context.log();
  if (!options.output.empty() && options.inputs.size() > 1) {
    log.report(Code("E0201"), {}, "-o takes one file; several are upgraded in place");
    return context.finish();
  }
  for (const std::string& input : options.inputs)
    if (workspace::extension_of(input) != ".pxn")
      log.report(Code("E0202"), {}, fmt::format("{} is not a .pxn file", in_quotes(input)));
  for (const std::string& input : options.inputs) context.files().will_read(input);
  std::error_code ignored;
  const bool in_place = options.output.empty() ||
                        std::filesystem::equivalent(options.output, options.inputs[0], ignored);
  for (const std::string& output : in_place ? options.inputs : std::vector{options.output})
    context.files().will_write(output, in_place ? "" : "-o", log,
                               in_place ? FileUses::Output::in_place : FileUses::Output::result);
  if (log.has_errors()) return context.finish();

  context.step("upgrade and compare");
  pxn::Options read;
  read.root = options.root;
  read.limits.bytes = options.max_input;
  const auto files = pxn::upgraded(options.inputs, read, log, context.job());
  // nothing is written when one of them cannot be
  if (!files) return context.finish();
  context.step("write");
  for (const pxn::UpgradedFile& file : *files) {
    const bool already = file.text.empty();
    context.result()["files"].push_back(
        {{"file", file.path}, {"upgraded", !already}, {"paths_changed", file.paths}});
    if (already) {
      if (!options.common.json) print(stderr, "{}: is of level 1 already\n", file.path);
      continue;
    }
    const std::string& output = options.output.empty() ? file.path : options.output;
    if (write_file(output, as_bytes(file.text), log)) context.wrote(output);
  }
  return context.finish();
}

}  // namespace
}  // namespace command_upgrade

Command upgrade_command() {
  return command("upgrade", "Rewrite pxn files of level 0 in level 1", command_upgrade::declare_all,
                 command_upgrade::run);
}

}  // namespace panwright::tools
