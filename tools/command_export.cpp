#include <fmt/core.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "exporters/export.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/posed_model.h"
#include "workspace/open.h"
#include "workspace/targets.h"

namespace panwright::tools {

namespace command_export {
namespace {

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::string input;
  std::string output;  // .glb
  bool articulations = false;
  PoseOptions pose;
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("input", options.input, "Model: a .pan, .pxn or CAD file").required().type("FILE");
  arguments.add("-o,--output", options.output, "glTF file to write").required().type("FILE.glb");
  arguments.flag(
      "--articulations", options.articulations,
      "Write joints as AGI_articulations; viewers without this extension show all joints at 0");
  declare(arguments, options.pose);
  declare(arguments, options.read);
  declare(arguments, options.read.cache);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

int run(const Options& options, const Host& host) {
  CommandContext context("export", options.common, host);
  DiagnosticLog& log = context.log();
  if (workspace::extension_of(options.output) != ".glb")
    log.report(Code("E0202"), {}, fmt::format("{} is not a .glb file", in_quotes(options.output)));
  context.files().will_read(options.input);
  context.files().will_write(options.output, "-o", log);
  if (log.has_errors()) return context.finish();
  if (workspace::extension_of(options.input) == ".pxn") context.summarise_imports();
  const auto read = options.read.opening(log);
  if (!read) return context.finish();
  workspace::OpenReport report;
  const auto model = workspace::open(options.input, *read, log, context.job(), &report);
  context.add_timings(report.steps);
  if (!model) return context.finish();
  const auto world = posed(options.input, *model, options.pose, log);
  if (!world) return context.finish();
  workspace::warn_of_terrain(*world, "a glTF file", log);
  const exporters::GlbOptions glb{options.articulations, (*world)[0].joint_values()};
  context.step("write");
  const auto bytes = exporters::glb_from(**model, log, context.job(), glb);
  if (!bytes || !write_file(options.output, *bytes, log)) return context.finish();
  context.wrote(options.output);
  context.result()["output"] = options.output;
  context.result()["bytes"] = bytes->size();
  return context.finish();
}

}  // namespace
}  // namespace command_export

Command export_command() {
  return command("export", "Write a model as a glTF file", command_export::declare_all,
                 command_export::run);
}

}  // namespace panwright::tools
