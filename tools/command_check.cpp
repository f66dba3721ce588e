#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "base/text.h"
#include "compiler/size.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/dem_tiles.h"
#include "tools/print.h"
#include "workspace/open.h"
#include "workspace/watch.h"

namespace panwright::tools {

namespace command_check {
namespace {

constexpr int kCancelled = 130;

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::vector<std::string> inputs;
  bool watch = false;
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("inputs", options.inputs, "Files to check").required().type("FILE…");
  declare(arguments, options.read);
  declare(arguments, options.read.open.cad);
  arguments.flag("--watch", options.watch,
                 "Check again whenever a file or what it includes changes, until interrupted");
  declare(arguments, options.common);
}

void check_one(const std::string& path, const workspace::OpenOptions& read, CommandContext& context,
               std::set<std::filesystem::path>& files) {
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
    if (model) workspace::add_inputs(**model, path, files);
    if (extension == ".pan") check_terrain(path, log, context.job());
    if (const auto bounds = model ? (*model)->world_bounds() : std::nullopt)
      size = compiler::size_in_words(bounds->extent());
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

// One round over all files. files: what they consist of, more and more of it
int check_all(const Options& options, const Host& host, std::set<std::filesystem::path>& files,
              bool& cancelled) {
  CommandContext context("check", options.common, host);
  auto read = options.read.opening(context.log());
  if (!read) return context.finish();
  read->prune = false;
  for (const std::string& path : options.inputs) check_one(path, *read, context, files);
  workspace::add_sources(context.log(), files);
  cancelled = context.job().cancelled();
  return context.finish();
}

int watch(const Options& options, const Host& host) {
  std::set<std::filesystem::path> files(options.inputs.begin(), options.inputs.end());
  for (;;) {
    // before they are read: what changes meanwhile is noticed
    std::vector<workspace::FileStamp> known;
    for (const std::filesystem::path& file : files) known.push_back(workspace::stamp_of(file));
    bool cancelled = false;
    (void)check_all(options, host, files, cancelled);
    if (cancelled) return kCancelled;
    for (const std::filesystem::path& file : files)
      if (std::none_of(known.begin(), known.end(),
                       [&](const auto& stamp) { return stamp.path == file; }))
        known.push_back(workspace::stamp_of(file));
    print("watching {}\n", counted(known.size(), "file"));
    std::fflush(stdout);
    while (!workspace::have_changed(known, host.job) && !host.job.cancelled())
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (host.job.cancelled()) return kCancelled;
    print("\n");
  }
}

int run(const Options& options, const Host& host) {
  if (options.watch && !options.common.json) return watch(options, host);
  std::set<std::filesystem::path> files;
  bool cancelled = false;
  if (!options.watch) return check_all(options, host, files, cancelled);
  CommandContext context("check", options.common, host);
  context.log().report(Code("E0201"), {}, "--watch cannot be combined with --json");
  return context.finish();
}

}  // namespace
}  // namespace command_check

Command check_command() {
  return command("check", "Check pxn, pan and CAD files and report all problems",
                 command_check::declare_all, command_check::run);
}

}  // namespace panwright::tools
