// panwright-bench [CASE…] [--list] [--out DIR] [--quick]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "base/file.h"
#include "bench/bench.h"
#include "bench/report.h"

namespace {

using namespace panwright;
using namespace panwright::bench;

struct Options {
  std::vector<std::string> names;
  std::string out;
  bool list = false;
  bool quick = false;
  bool strict = false;
};

void print_list() {
  for (const Case& one : cases()) fmt::print("{:<12} {}\n", one.name, one.what);
}

bool is_case(const std::string& name) {
  for (const Case& one : cases())
    if (one.name == name) return true;
  return false;
}

// False: a file could not be written.
bool run_case(const Case& one, const Options& options, const std::filesystem::path& programs,
              int& misses) {
  Context context(options.quick, programs);
  one.run(context);
  fmt::print("{}", to_table(context));
  std::fflush(stdout);
  misses += missed(context.rows());
  if (options.out.empty()) return true;
  DiagnosticLog log;
  const std::filesystem::path path = std::filesystem::path(options.out) / (one.name + ".csv");
  if (write_file(path, as_bytes(to_csv(context, one)), log)) return true;
  fmt::print(stderr, "{}", to_text(log));
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Speed against error. Each case writes DIR/CASE.csv.", "panwright-bench");
  app.add_option("cases", options.names, "the cases to run; all of them by default");
  app.add_flag("--list", options.list, "name the cases and stop");
  app.add_option("--out", options.out, "folder for one CSV file a case");
  app.add_flag("--quick", options.quick, "small sizes and few runs: whether it works at all");
  app.add_flag("--strict", options.strict, "exit with 1 when a bound is missed");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (options.list) {
    print_list();
    return 0;
  }
  for (const std::string& name : options.names) {
    if (is_case(name)) continue;
    fmt::print(stderr, "error: no case '{}'; --list names them\n", name);
    return 2;
  }
  std::error_code error;
  if (!options.out.empty()) std::filesystem::create_directories(options.out, error);
  if (error) {
    fmt::print(stderr, "error: cannot make the folder '{}': {}\n", options.out, error.message());
    return 3;
  }
  const std::filesystem::path programs = std::filesystem::canonical("/proc/self/exe").parent_path();
  int misses = 0;
  bool written = true;
  for (const Case& one : cases()) {
    const auto& names = options.names;
    if (!names.empty() && std::find(names.begin(), names.end(), one.name) == names.end()) continue;
    written = run_case(one, options, programs, misses) && written;
  }
  if (misses > 0) fmt::print("{} of the rows miss a bound\n", misses);
  if (!written) return 3;
  return options.strict && misses > 0 ? 1 : 0;
}
