// panwright-studio: the window. `panwright view` starts it.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "base/text.h"
#include "studio/window.h"

using namespace panwright;

namespace {

// As every command does (docs/json-output.md).
void print(const studio::Report& report, int code, const DiagnosticLog& log) {
  nlohmann::ordered_json out;
  out["schema"] = 1;
  out["schema_id"] = "panwright/view/1";
  out["command"] = "view";
  out["frames"] = report.spent.count();
  out["ui_ms"] = {{"median", report.spent.at(0.5)},
                  {"p99", report.spent.at(0.99)},
                  {"most", report.spent.largest()},
                  {"most_cpu", report.busy}};
  out["first_image_ms"] = 1e3 * report.first_image;
  out["following"] = {{"images", report.drawing.quick},
                      {"ms", 1e3 * report.drawing.frame_seconds},
                      {"scale", report.drawing.scale},
                      {"coarser", report.drawing.coarser},
                      {"rate", report.drawing.rate}};
  if (report.saved.count() > 0)
    out["save_to_image_ms"] = {{"count", report.saved.count()},
                               {"median", 1e3 * report.saved.at(0.5)},
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
  out["exact"] = report.drawing.exact_count;
  out["readings"] = report.readings;
  out["renderer"] = report.drawing.renderer;
  out["render"] = report.command;
  out["exit_code"] = code;
  auto diagnostics = nlohmann::ordered_json::parse(to_json(log));
  for (const char* key : {"errors", "warnings", "notes", "hidden", "diagnostics"})
    out[key] = std::move(diagnostics[key]);
  std::puts(out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
}

}  // namespace

int main(int argc, char** argv) {
  studio::Options options;
  DiagnosticLog log;
  std::string script;
  bool good = true;
  const auto wrong = [&](const std::string& what) {
    log.report(Code::E0201, {}, what);
    good = false;
  };
  bool names = false;  // only files follow
  bool json = false;
  std::optional<std::pair<std::uint32_t, std::uint32_t>> sized;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const auto value = [&]() -> std::string { return i + 1 < argc ? argv[++i] : ""; };
    if (names)
      options.files.emplace_back(word);
    else if (word == "--")
      names = true;
    else if (word == "--json")
      json = true;
    else if (word == "--script")
      script = value();
    else if (word == "--size") {
      const std::string size = value();
      std::uint32_t wide = 0, high = 0;
      if (std::sscanf(size.c_str(), "%ux%u", &wide, &high) != 2 || wide < 320 || high < 240 ||
          wide > 16384 || high > 16384)
        wrong("--size is '" + size + "', expected 320x240 to 16384x16384");
      sized = {wide, high};
    } else if (word == "--scale") {
      const std::string scale = value();
      options.scale = parse_double(scale).value_or(0);
      if (!(options.scale >= 0.5 && options.scale <= 8))
        wrong("--scale is '" + scale + "', expected 0.5 to 8");
    } else if (word == "-D") {
      const std::string define = value();
      const auto equals = define.find('=');
      if (equals == std::string::npos || equals == 0)
        wrong("--define is '" + define + "', expected NAME=VALUE");
      else
        options.open.parameters.emplace_back(define.substr(0, equals), define.substr(equals + 1));
    } else if (word == "--gl") {
      const std::string kind = value();
      options.context = kind == "osmesa" ? preview::ContextKind::osmesa
                        : kind == "egl"  ? preview::ContextKind::egl
                                         : preview::ContextKind::automatic;
    }
  }
  if (options.files.empty()) {
    std::fputs("panwright-studio: part of panwright; `panwright view FILE…` starts it\n", stderr);
    return 2;
  }
  options.open.prune = false;
  options.open.cache = workspace::user_cache_folder();
  if (good && !script.empty()) {
    auto steps = studio::read_script(script, log);
    good = static_cast<bool>(steps);
    if (good) options.script = *std::move(steps);
    options.folder = std::filesystem::path(script).parent_path();
    options.with_script = true;
  }
  // scripts find the same window each time
  if (script.empty()) {
    options.layout_file = studio::layout_file();
    options.layout = studio::read_layout(options.layout_file, options.layout_problem);
  }
  if (sized) std::tie(options.layout.width, options.layout.height) = *sized;
  studio::Report report;
  good = good && studio::run(options, log, &report);
  const int code = exit_code(log);
  if (json)
    print(report, code, log);
  else
    std::fputs(to_text(log).c_str(), stderr);
  return good || code != 0 ? code : 1;
}
