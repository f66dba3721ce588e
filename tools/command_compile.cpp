#include <fmt/core.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "base/file.h"
#include "base/text.h"
#include "tools/budget_report.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"
#include "workspace/open.h"
#include "workspace/terrain.h"

namespace panwright::tools {

namespace command_compile {
namespace {

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::string input;
  std::string output;
  std::string depfile;
  std::string budget_report;
  std::string license;  // of the original tools: accepted, ignored, noted
  bool strip_sources = false;
  bool mesh_levels = false;
  std::string compress;  // pan::StorageForm
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("input", options.input, "Model to compile, a .pxn file")
      .required()
      .type("FILE.pxn");
  arguments
      .add("-o,--output", options.output,
           "Pan file to write (default: the input's name with .pan, in the working directory)")
      .type("FILE.pan");
  arguments
      .add("-M,--depfile", options.depfile,
           "Write the list of files read, as a dependency file for Make and Ninja")
      .type("FILE");
  arguments
      .add("--budget-report", options.budget_report,
           "Write a report of the budget and of triangles by part: .txt, .json or .html")
      .type("FILE");
  arguments.flag("--strip-sources", options.strip_sources, "Omit the source locations of parts");
  arguments.flag(
      "--mesh-levels", options.mesh_levels,
      "Add coarser meshes for far views, with error bounds (seconds per 100000 triangles)");
  declare_compress(arguments, options.compress);
  declare(arguments, options.read);
  declare(arguments, options.read.cache);
  declare(arguments, options.common);
}

void declare_converter(Arguments& arguments, Options& options) {
  declare_all(arguments, options);
  arguments.add("--lic", options.license, "Licence file (-lic FILE), accepted and ignored")
      .type("FILE");
}

// A file name in a Makefile rule.
std::string make_escaped(const std::string& path) {
  std::string out;
  for (const char c : path) {
    if (c == ' ' || c == '#' || c == '\\' || c == ':') out.push_back('\\');
    if (c == '$') out.push_back('$');
    out.push_back(c);
  }
  return out;
}

// The dependency file; nothing where a name does not fit into one: reported.
Result<std::string> dependencies(const Options& options, const std::string& output,
                                 const std::vector<scene::Input>& inputs, DiagnosticLog& log) {
  const auto folder = std::filesystem::path(options.input).parent_path();
  bool good = true;
  const auto named = [&](const std::string& path) {
    if (path.find_first_of("\n\r") != path.npos) {
      log.report_file(Code("E0103"), options.depfile,
                      fmt::format("the name {} has a line end, which dependency files cannot hold",
                                  in_quotes(path)));
      good = false;
    }
    return make_escaped(path);
  };
  std::string text = named(output) + ":";
  for (const scene::Input& input : inputs)
    text += " \\\n  " + named((folder / input.path).lexically_normal().string());
  if (!good) return failed;
  return text + "\n";
}

nlohmann::ordered_json as_json(const compiler::Report& report) {
  return {{"bytes", report.bytes},
          {"triangles", report.triangles},
          {"unique_triangles", report.unique_triangles},
          {"unique_meshes", report.unique_meshes},
          {"instances", report.instances},
          {"worst_error", report.worst_error}};
}

// Terrain in place of nodes.
int tile(const Options& options, const std::string& output, scene::Scene& scene,
         const pxn::TerrainText& terrain, CommandContext& context) {
  DiagnosticLog& log = context.log();
  if (output == "-") {
    log.report(Code("E0201"), {}, "terrain is written to a file, not to standard output");
    return context.finish();
  }
  const auto folder = std::filesystem::path(options.input).parent_path();
  context.step("tile");
  const auto made = workspace::write_terrain(terrain, folder, output, log, context.job());
  if (!made) return context.finish();
  context.wrote(output, counted(made->tiles.tiles, "tile"));
  if (!options.depfile.empty()) {
    std::set<std::string> known;  // several parts may be of one file
    for (const std::string& file : made->files)
      if (known.insert(file).second)
        scene.inputs.push_back(
            {std::filesystem::path(file).lexically_relative(folder).string(), {}, 0});
    const auto rule = dependencies(options, output, scene.inputs, log);
    if (rule && write_file(options.depfile, as_bytes(*rule), log)) context.wrote(options.depfile);
  }
  context.result()["output"] = output;
  compiler::Report none;
  none.bytes = made->tiles.bytes;
  none.worst_error = made->tiles.error;
  context.result().update(as_json(none));
  context.result()["tiles"] = made->tiles.tiles;
  context.result()["storage"] = storage_json(options.compress, none.storage);
  return context.finish();
}

int run(const Options& options, const Host& host) {
  CommandContext context("compile", options.common, host);
  DiagnosticLog& log = context.log();
  if (!options.license.empty())
    log.report(Code("N0205"), {}, "-lic is ignored: no licence file is needed");
  if (workspace::extension_of(options.input) != ".pxn") {
    log.report(Code("E0202"), {}, fmt::format("{} is not a .pxn file", in_quotes(options.input)));
    return context.finish();
  }
  const std::string output =
      options.output.empty()
          ? std::filesystem::path(options.input).filename().replace_extension(".pan").string()
          : options.output;

  if (workspace::extension_of(output) != ".pan" && output != "-") {
    log.report(Code("E0202"), {}, fmt::format("{} is not a .pan file", in_quotes(output)));
    return context.finish();
  }
  context.files().will_read(options.input);
  context.files().will_write(output, "-o", log);
  context.files().will_write(options.depfile, "--depfile", log);
  context.files().will_write(options.budget_report, "--budget-report", log);
  if (log.has_errors()) return context.finish();
  const auto read = options.read.opening(log);
  if (!read) return context.finish();
  workspace::OpenReport steps;
  std::optional<pxn::TerrainText> terrain;
  auto scene = workspace::read_scene(options.input, *read, log, context.job(), &steps, &terrain);
  // what could be read is written only where the user named the output
  if (!scene || (log.has_errors() && (options.output.empty() || terrain))) {
    if (scene)
      context.left_out(terrain ? CommandContext::LeftOut::terrain
                               : CommandContext::LeftOut::unnamed);
    context.add_timings(steps.steps);
    if (!read->cache.empty()) context.add_work(steps.work);
    return context.finish();
  }
  if (terrain) return tile(options, output, *scene, *terrain, context);
  std::string rule;
  if (!options.depfile.empty()) {
    const auto made = dependencies(options, output, scene->inputs, log);
    if (!made) return context.finish();
    rule = *made;
  }
  const auto report = workspace::write_pan(*scene, *read,
                                           {.output = output,
                                            .strip_sources = options.strip_sources,
                                            .mesh_levels = options.mesh_levels,
                                            .storage = storage_of(options.compress),
                                            .check_size = true,
                                            .origin = {}},
                                           log, context.job(), &steps);
  context.add_timings(steps.steps);
  if (!read->cache.empty()) context.add_work(steps.work);
  // what was cancelled has made nothing that could depend on the inputs
  if (!options.depfile.empty() && !context.job().cancelled() &&
      write_file(options.depfile, as_bytes(rule), log))
    context.wrote(options.depfile);
  if (!report) return context.finish();
  context.wrote(output, counted(report->triangles, "triangle") +
                            (options.mesh_levels
                                 ? fmt::format(", {} of detail", counted(report->levels, "level"))
                                 : "") +
                            storage_words(options.compress, report->storage));
  if (!options.budget_report.empty())
    write_budget_report(options.budget_report, options.input, scene->budget, *report, context);
  context.result()["output"] = output;
  context.result().update(as_json(*report));
  context.result()["storage"] = storage_json(options.compress, report->storage);
  if (scene->budget.any()) context.result()["budget"] = budget_json(scene->budget, *report);
  return context.finish();
}

}  // namespace
}  // namespace command_compile

Command compile_command() {
  return command("compile", "Compile a pxn model into a pan file", command_compile::declare_all,
                 command_compile::run);
}

Command converter_command(const std::string& name) {
  return command(
      name,
      fmt::format("{}: compile a pxn model into a pan file; the same as 'panwright compile'", name),
      command_compile::declare_converter, command_compile::run);
}

}  // namespace panwright::tools
