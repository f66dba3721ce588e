#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "compiler/size.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"
#include "workspace/open.h"

namespace panwright::tools {

namespace {

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::vector<std::string> inputs;
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("inputs", options.inputs, "Files to check").required().type("FILE…");
  declare(arguments, options.read);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

void check_one(const std::string& path, const workspace::OpenOptions& read,
               CommandContext& context) {
  DiagnosticLog& log = context.log();
  const std::string extension = workspace::extension_of(path);
  const std::size_t errors = log.errors(), warnings = log.warnings();
  std::string format, how;  // of a .pan
  std::string size;         // in words
  if (extension == ".pan" || extension == ".pxn" || workspace::is_cad(path)) {
    workspace::OpenReport report;
    // a text is compiled too, to find it all
    const auto model = workspace::open(path, read, log, context.job(), &report);
    context.add_timings(report.steps);
    if (const auto bounds = model ? (*model)->world_bounds() : std::nullopt)
      size = compiler::size_in_words(bounds->max - bounds->min);
    if (model && extension == ".pan") {
      format = fmt::format("{}.{}", (*model)->header().major, (*model)->header().minor);
      if ((*model)->compressed()) how = " (compressed)";
    }
  } else {
    workspace::report_unknown_format(path, log);
  }
  const std::size_t found = log.errors() - errors;
  context.result()["files"].push_back({{"file", path},
                                       {"ok", found == 0},
                                       {"errors", found},
                                       {"warnings", log.warnings() - warnings}});
  if (!format.empty()) {
    context.result()["files"].back()["format"] = format;
    context.result()["files"].back()["compressed"] = !how.empty();
  }
  if (!size.empty()) context.result()["files"].back()["size"] = size;
  if (!context.options().json && found == 0)
    print("{}: ok{}{}\n", path, how, size.empty() ? "" : ", " + size);
}

int run(const Options& options, const Host& host) {
  CommandContext context("check", options.common, host);
  auto read = options.read.opening(context.log());
  if (!read) return context.finish();
  read->prune = false;
  for (const std::string& path : options.inputs) check_one(path, *read, context);
  return context.finish();
}

}  // namespace

Command check_command() {
  return command("check", "Check pxn, pan and CAD files and report every problem", declare_all,
                 run);
}

}  // namespace panwright::tools
