#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "labels/convert.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "workspace/open.h"

namespace panwright::tools {

namespace command_labels {
namespace {

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::string folder;
  std::string output;
  std::vector<std::string> formats;
  std::vector<std::string> targets;  // NAME or NAME=FILE
};

void declare_all(Arguments& arguments, Options& options) {
  static const std::vector<std::string_view> kNames = [] {
    std::vector<std::string_view> names;
    for (const labels::FormatInfo& info : labels::formats()) names.push_back(info.name);
    return names;
  }();
  static const std::string kHelp = [] {
    std::string text = "Format to write; may be repeated, or a list with commas:";
    for (const labels::FormatInfo& info : labels::formats())
      text += fmt::format("{} {} ({})", &info == &labels::formats()[0] ? "" : ",", info.name,
                          info.files);
    return text;
  }();
  arguments.add("folder", options.folder, "Folder of frames with labels, NAME.labels.json of `run`")
      .required()
      .type("FOLDER");
  arguments
      .add("-o,--output", options.output,
           "Folder to write; of several formats each has a folder of its own there")
      .required()
      .type("FOLDER");
  arguments.add("--format", options.formats, kHelp.c_str())
      .required()
      .type("NAME")
      .one_value()
      .some_of(kNames);
  arguments
      .add("--target", options.targets,
           "Write this target alone, and its parts; may be repeated. FILE: its model, a .pan, .pxn "
           "or CAD file, for formats that hold one (bop)")
      .type("NAME[=FILE]")
      .one_value();
  declare(arguments, options.read);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

// Splits what may be a list with commas.
std::vector<std::string> names_of(const std::vector<std::string>& given) {
  std::vector<std::string> out;
  for (const std::string& text : given)
    for (std::size_t at = 0; at <= text.size();) {
      const std::size_t end = std::min(text.find(',', at), text.size());
      out.push_back(text.substr(at, end - at));
      at = end + 1;
    }
  return out;
}

int run(const Options& options, const Host& host) {
  CommandContext context("labels", options.common, host);
  DiagnosticLog& log = context.log();
  labels::Conversion conversion;
  conversion.folder = options.folder;
  conversion.output = options.output;
  conversion.formats = names_of(options.formats);
  const auto read = options.read.opening(log);
  if (!read) return context.finish();
  for (const std::string& text : options.targets) {
    const std::size_t equals = text.find('=');
    conversion.targets.push_back(text.substr(0, equals));
    if (equals == std::string::npos) continue;
    const std::string file = text.substr(equals + 1);
    context.files().will_read(file);
    workspace::OpenReport report;
    const auto model = workspace::open(file, *read, log, context.job(), &report);
    context.add_timings(report.steps);
    if (!model || log.has_errors()) return context.finish();
    conversion.models.push_back({conversion.targets.back(), *model});
  }
  context.step("convert");
  const auto converted = labels::convert(conversion, log, context.job());
  if (!converted) return context.finish();
  for (const auto& file : converted->files) context.wrote(file.string());
  context.result()["output"] = options.output;
  context.result()["formats"] = conversion.formats;
  context.result()["frames"] = converted->frames;
  if (!options.common.json)
    fmt::print(stderr, "{} of {} converted\n", counted(converted->frames, "frame"), options.folder);
  return context.finish();
}

}  // namespace
}  // namespace command_labels

Command labels_command() {
  return command("labels", "Write the labels of frames in formats of data sets",
                 command_labels::declare_all, command_labels::run);
}

}  // namespace panwright::tools
