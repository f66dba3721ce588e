// panwright-bench [CASE…] [--list] [--out DIR] [--quick]
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "bench/bench.h"
#include "bench/report.h"

namespace {

using namespace panwright;
using namespace panwright::bench;

constexpr const char* kHelp =
    "Speed against error. Each case writes DIR/CASE.csv.\n\n"
    "Usage: panwright-bench [OPTIONS] [CASE…]\n\n"
    "  CASE…       Cases to run (default: all)\n"
    "  -h, --help  Print this help\n"
    "  --list      List the cases and exit\n"
    "  --out DIR   Folder of one CSV file per case\n"
    "  --processor-time\n"
    "              Processor time of all threads in place of the time that passes\n"
    "  --quick     Small sizes and few runs, as a test of the cases\n"
    "  --strict    Exit with 1 if a row misses its bound\n";

struct Options {
  std::vector<std::string> names;
  std::string out;
  bool list = false;
  bool quick = false;
  bool strict = false;
  bool help = false;

  // Returns false for an unknown option, or one without its value.
  bool parse(std::span<char*> words) {
    for (std::size_t i = 0; i < words.size(); ++i) {
      const std::string_view word = words[i];
      if (word == "-h" || word == "--help")
        help = true;
      else if (word == "--list")
        list = true;
      else if (word == "--processor-time")
        use_processor_time();
      else if (word == "--quick")
        quick = true;
      else if (word == "--strict")
        strict = true;
      else if (word.starts_with("--out="))
        out = word.substr(6);
      else if (word == "--out" && i + 1 < words.size())
        out = words[++i];
      else if (word.starts_with('-'))
        return false;
      else
        names.emplace_back(word);
    }
    return true;
  }
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
  if (!options.parse({argv + 1, argv + argc})) {
    fmt::print(stderr, "{}", kHelp);
    return 2;
  }
  if (options.help) {
    fmt::print("{}", kHelp);
    return 0;
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
