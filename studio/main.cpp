// panwright-studio: the window. `panwright view` starts it.
#include <cmath>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "base/text.h"
#include "studio/window.h"

namespace panwright::studio {
namespace {

// Prints the report as JSON (docs/json-output.md).
void print_report(const Report& report, int code, const DiagnosticLog& log) {
  nlohmann::ordered_json out;
  out["schema"] = 1;
  out["schema_id"] = "panwright/view/1";
  out["command"] = "view";
  out["frames"] = report.spent.count();
  out["ui_ms"] = {{"median", report.spent.quantile(0.5)},
                  {"p99", report.spent.quantile(0.99)},
                  {"most", report.spent.largest()},
                  {"most_cpu", report.busy}};
  out["first_image_ms"] = 1e3 * report.first_image;
  out["following"] = {{"images", report.rendering.interactive_count},
                      {"ms", 1e3 * report.rendering.frame_seconds},
                      {"scale", report.rendering.resolution_scale},
                      {"coarser", report.rendering.level_scale},
                      {"rate", report.rendering.rate}};
  if (report.saved.count() > 0)
    out["save_to_image_ms"] = {{"count", report.saved.count()},
                               {"median", 1e3 * report.saved.quantile(0.5)},
                               {"most", 1e3 * report.saved.largest()},
                               {"last",
                                {{"noticed", 1e3 * report.last_saved.noticed},
                                 {"read", 1e3 * report.last_saved.read},
                                 {"shown", 1e3 * report.last_saved.shown}}}};
  if (report.resident.count() > 0) {
    out["memory"] = {{"every", report.resident.every()}, {"mib", nlohmann::ordered_json::array()}};
    for (const double bytes : report.resident.kept())
      out["memory"]["mib"].push_back(std::round(bytes / (1 << 20) * 10) / 10);
  }
  out["exact"] = report.rendering.exact_count;
  out["readings"] = report.readings;
  out["renderer"] = report.rendering.renderer;
  out["render"] = report.command;
  out["exit_code"] = code;
  auto diagnostics = nlohmann::ordered_json::parse(to_json(log));
  for (const char* key : {"errors", "warnings", "notes", "hidden", "diagnostics"})
    out[key] = std::move(diagnostics[key]);
  std::puts(out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
}

// Arguments of `panwright view`, which has checked them and passes them on.
struct Arguments {
  Options options;
  std::string script;
  bool json = false;
  std::optional<std::pair<std::uint32_t, std::uint32_t>> size;
};

// Returns false after an error.
bool parse_option(std::string_view option, const std::string& value, Arguments& arguments,
                  DiagnosticLog& log) {
  const auto fail = [&](const std::string& what) {
    log.report(Code("E0201"), {}, what);
    return false;
  };
  Options& options = arguments.options;
  if (option == "--script") {
    arguments.script = value;
  } else if (option == "--size") {
    std::uint32_t width = 0, height = 0;
    if (std::sscanf(value.c_str(), "%ux%u", &width, &height) != 2 || width < 320 || height < 240 ||
        width > 16384 || height > 16384)
      return fail("--size is '" + value + "', expected 320x240 to 16384x16384");
    arguments.size = {width, height};
  } else if (option == "--scale") {
    options.scale = parse_double(value).value_or(0);
    if (!(options.scale >= 0.5 && options.scale <= 8))
      return fail("--scale is '" + value + "', expected 0.5 to 8");
  } else if (option == "--owner") {
    options.owner = value;
  } else if (option == "--camera-file") {
    options.camera_file = value;
  } else if (option == "-D") {
    const auto equals = value.find('=');
    if (equals == std::string::npos || equals == 0)
      return fail("--define is '" + value + "', expected NAME=VALUE");
    options.open.parameters.emplace_back(value.substr(0, equals), value.substr(equals + 1));
  } else if (option == "--gl") {
    options.context = value == "osmesa" ? preview::ContextKind::osmesa
                      : value == "egl"  ? preview::ContextKind::egl
                                        : preview::ContextKind::automatic;
  }
  return true;
}

bool parse_arguments(int argc, char** argv, Arguments& arguments, DiagnosticLog& log) {
  bool ok = true;
  int i = 1;
  for (; i < argc && std::string_view(argv[i]) != "--"; ++i) {
    const std::string_view word = argv[i];
    if (word == "--json") {
      arguments.json = true;
      continue;
    }
    ++i;  // its value
    ok = parse_option(word, i < argc ? argv[i] : "", arguments, log) && ok;
  }
  for (++i; i < argc; ++i) arguments.options.files.emplace_back(argv[i]);
  return ok;
}

int main_of_studio(int argc, char** argv) {
  DiagnosticLog log;
  Arguments arguments;
  Options& options = arguments.options;
  bool ok = parse_arguments(argc, argv, arguments, log);
  if (options.files.empty()) {
    std::fputs("panwright-studio: part of panwright; `panwright view FILE…` starts it\n", stderr);
    return 2;
  }
  options.open.prune = false;
  options.open.cache = workspace::user_cache_folder();
  if (ok && !arguments.script.empty()) {
    auto steps = read_script(arguments.script, log);
    ok = static_cast<bool>(steps);
    if (ok) options.script = *std::move(steps);
    options.script_folder = std::filesystem::path(arguments.script).parent_path();
    options.scripted = true;
  }
  // scripts always begin with the default layout
  if (arguments.script.empty()) {
    options.layout_file = layout_file();
    options.layout = read_layout(options.layout_file, options.layout_problem);
  }
  if (arguments.size) std::tie(options.layout.width, options.layout.height) = *arguments.size;
  Report report;
  try {
    ok = ok && run(options, log, &report);
  } catch (const std::exception&) {
    report_exception(log);
  }
  const int code = exit_code(log);
  if (arguments.json)
    print_report(report, code, log);
  else
    std::fputs(to_text(log).c_str(), stderr);
  return ok || code != 0 ? code : 1;
}

}  // namespace
}  // namespace panwright::studio

int main(int argc, char** argv) { return panwright::studio::main_of_studio(argc, argv); }
