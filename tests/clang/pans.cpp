// Makes pan files of models as `panwright compile` and `panwright import` do: the program without
// what draws, so that it is quickly built with another compiler.
//
//   pans THREADS FILE OUTPUT [FILE OUTPUT]…

#include <cstdio>
#include <cstdlib>

#include "workspace/open.h"

using namespace panwright;

int main(int argc, char** argv) {
  if (argc < 4 || argc % 2 != 0) return std::fputs("pans THREADS FILE OUTPUT…\n", stderr), 2;
  const Job job({.threads = std::strtoul(argv[1], nullptr, 10), .progress = {}});
  int code = 0;
  for (int i = 2; i < argc; i += 2) {
    DiagnosticLog log;
    workspace::WriteOptions write;
    write.output = argv[i + 1];
    // options that `import` records
    if (workspace::is_cad(argv[i])) write.origin = " assume=";
    auto scene = workspace::read_scene(argv[i], {}, log, job);
    if (scene && workspace::write_pan(*scene, {}, write, log, job)) continue;
    std::fprintf(stderr, "%s\n%s", argv[i], to_text(log).c_str());
    code = 1;
  }
  return code;
}
