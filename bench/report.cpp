#include "bench/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <thread>

namespace panwright::bench {

namespace {

std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t colon = line.find(':');
    if (colon != std::string::npos && colon + 2 < line.size()) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string compiler() {
#if defined(__clang__)
  return fmt::format("clang {}", __clang_version__);
#else
  return fmt::format("gcc {}", __VERSION__);
#endif
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

bool misses_speed(const Row& row) {
  if (row.must == 0) return false;
  return row.must_is_least ? !(row.speed >= row.must) : !(row.speed <= row.must);
}

bool misses_error(const Row& row) { return row.must_error != 0 && !(row.error <= row.must_error); }

}  // namespace

std::string machine_header(const Context& context) {
  return fmt::format(
      "# processor: {}\n# cores: {}\n# compiler: {}\n# build: {}\n# OpenGL renderer: {}\n"
      "# size: {}\n{}",
      cpu_model(), std::thread::hardware_concurrency(), compiler(), PANWRIGHT_BUILD_TYPE,
      context.renderer(), context.quick() ? "quick (a smoke test, not a measurement)" : "full",
      uses_processor_time() ? "# time: of the processor, all threads\n" : "");
}

std::string to_csv(const Context& context, const Case& one) {
  std::string out = fmt::format("# case: {}: {}\n{}", one.name, one.what, machine_header(context));
  for (const std::string& note : context.notes()) out += fmt::format("# note: {}\n", note);
  out +=
      "case,setting,speed,speed_unit,spread,runs,error,error_unit,reference,reference_error,"
      "must_speed,must_error,met\n";
  for (const Row& row : context.rows()) {
    const std::string must =
        row.must == 0 ? "" : fmt::format("{}{:g}", row.must_is_least ? ">=" : "<=", row.must);
    const std::string must_error = row.must_error == 0 ? "" : fmt::format("<={:g}", row.must_error);
    const bool bound = row.must != 0 || row.must_error != 0;
    out += fmt::format(
        "{},{},{:.6g},{},{:.3g},{},{:.6g},{},{},{:.3g},{},{},{}\n", quoted(row.case_name),
        quoted(row.setting), row.speed, quoted(row.speed_unit), row.spread, row.runs, row.error,
        quoted(row.error_unit), quoted(row.reference), row.reference_error, must, must_error,
        !bound                                   ? ""
        : misses_speed(row) || misses_error(row) ? "no"
                                                 : "yes");
  }
  return out;
}

std::string to_table(const Context& context) {
  std::size_t case_width = 4;
  std::size_t setting_width = 7;
  for (const Row& row : context.rows()) {
    case_width = std::max(case_width, row.case_name.size());
    setting_width = std::max(setting_width, row.setting.size());
  }
  std::string out;
  for (const Row& row : context.rows())
    out += fmt::format(
        "{:<{}}  {:<{}}  {:>10.4g} {:<9} ±{:<8.2g} {:>10.3g} {:<9} against {} (±{:.2g}){}{}\n",
        row.case_name, case_width, row.setting, setting_width, row.speed, row.speed_unit,
        row.spread, row.error, row.error_unit, row.reference, row.reference_error,
        misses_speed(row) ? fmt::format("  MISSES {} {:g} {}", row.must_is_least ? "≥" : "≤",
                                        row.must, row.speed_unit)
                          : "",
        misses_error(row) ? fmt::format("  MISSES error ≤ {:g}", row.must_error) : "");
  for (const std::string& note : context.notes()) out += fmt::format("note: {}\n", note);
  return out;
}

int missed(const std::vector<Row>& rows) {
  return static_cast<int>(std::count_if(rows.begin(), rows.end(), [](const Row& row) {
    return misses_speed(row) || misses_error(row);
  }));
}

}  // namespace panwright::bench
