#include <fmt/core.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "pxn/writer.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"
#include "workspace/open.h"

namespace panwright::tools {

namespace command_expand {
namespace {

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::string input;
  std::string output;
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("input", options.input, "Model to expand, a .pxn file").required().type("FILE.pxn");
  arguments
      .add("-o,--output", options.output,
           "Text to write, and its images beside it as PNG unless they exist (-: standard output, "
           "without textures)")
      .required()
      .type("FILE.pxn");
  declare(arguments, options.read);
  declare(arguments, options.read.cache);
  declare(arguments, options.common);
}

int run(const Options& options, const Host& host) {
  CommandContext context("expand", options.common, host);
  DiagnosticLog& log = context.log();
  const bool standard = options.output == "-";
  for (const std::string& path : {options.input, options.output})
    if (workspace::extension_of(path) != ".pxn" && !(standard && path == options.output))
      log.report(Code("E0202"), {}, fmt::format("{} is not a .pxn file", in_quotes(path)));
  context.files().will_read(options.input);
  context.files().will_write(options.output, "-o", log);
  if (log.has_errors()) return context.finish();

  const auto read = options.read.opening(log);
  if (!read) return context.finish();
  workspace::OpenReport report;
  auto scene = workspace::read_scene(options.input, *read, log, context.job(), &report);
  // the text has no imports, and so nothing that would take hidden parts away later
  const bool pruned = scene && workspace::prune(*scene, *read, log, context.job(), &report);
  context.add_timings(report.steps);
  if (!scene || !pruned) return context.finish();
  context.step("write");
  std::vector<std::string> images;
  if (!standard) {
    auto written = pxn::write_textures(*scene, options.output, log);
    if (!written) return context.finish();
    images = std::move(*written);
  }
  const std::string text = standard
                               ? pxn::to_text(*scene)
                               : pxn::to_text(*scene, [&](std::size_t i) { return images[i]; });
  const bool done = write_file(options.output, as_bytes(text), log);
  if (done) context.wrote(options.output, counted(scene->instances.size(), "shape"));
  context.result()["output"] = options.output;
  context.result()["nodes"] = scene->nodes.size();
  context.result()["shapes"] = scene->instances.size();
  context.result()["images"] = images;
  return context.finish();
}

}  // namespace
}  // namespace command_expand

Command expand_command() {
  return command("expand",
                 "Write a model as one pxn file without parts, repeats, includes and expressions",
                 command_expand::declare_all, command_expand::run);
}

}  // namespace panwright::tools
