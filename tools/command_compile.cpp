#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "compiler/compile.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/session.h"

namespace panwright::tools {

namespace {

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

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return std::filesystem::equivalent(a, b, ignored);
}

void write_depfile(const CompileOptions& options, const std::string& output,
                   const scene::Scene& scene, DiagnosticLog& log) {
  const auto folder = std::filesystem::path(options.input).parent_path();
  std::string text = make_escaped(output) + ":";
  for (const scene::Input& input : scene.inputs)
    text += " \\\n  " + make_escaped((folder / input.path).lexically_normal().string());
  text += "\n";
  write_file(options.depfile, as_bytes(text), log);
}

nlohmann::ordered_json as_json(const compiler::Report& report) {
  return {{"bytes", report.bytes},
          {"triangles", report.triangles},
          {"unique_triangles", report.unique_triangles},
          {"unique_meshes", report.unique_meshes},
          {"instances", report.instances},
          {"worst_error", report.worst_error}};
}

}  // namespace

int compile(const CompileOptions& options) {
  Session session("compile", options.common);
  DiagnosticLog& log = session.log();
  if (!options.license.empty())
    log.report(Code::N0205, {}, "-lic is ignored: no licence file is needed");
  if (extension_of(options.input) != ".pxn") {
    log.report(Code::E0202, {}, fmt::format("{} is not a .pxn file", in_quotes(options.input)));
    return session.finish();
  }
  const std::string output =
      options.output.empty()
          ? std::filesystem::path(options.input).replace_extension(".pan").string()
          : options.output;

  if (extension_of(output) != ".pan" && output != "-") {
    log.report(Code::E0202, {}, fmt::format("{} is not a .pan file", in_quotes(output)));
    return session.finish();
  }
  if (!options.depfile.empty() && same_file(options.depfile, options.input)) {
    log.report(Code::E0201, {}, "--depfile names the input: it would be overwritten");
    return session.finish();
  }
  auto scene = read_scene(options.input, options.read, session);
  // what could be read is written only where the user said where to
  if (!scene || (log.has_errors() && options.output.empty())) return session.finish();
  if (!options.depfile.empty()) write_depfile(options, output, *scene, log);

  prune(*scene, options.read, session);
  compiler::Options compile;
  compile.max_error = options.read.max_error;
  compile.max_triangles = options.read.max_triangles;
  compile.strip_sources = options.strip_sources;
  compile.compress = options.compress;
  session.step({});
  const auto report = compiler::compile(*scene, compile, output, log);
  if (!report) return session.finish();
  session.add_timing("tessellate", report->seconds_tessellate);
  session.add_timing("write", report->seconds_write);
  session.add_timing("sync to disk", report->seconds_sync);
  session.result()["output"] = output;
  session.result().update(as_json(*report));
  if (!options.common.json && log.has_errors())
    fmt::print(stderr, "panwright: wrote {} without what could not be read or made\n", output);
  return session.finish();
}

}  // namespace panwright::tools
