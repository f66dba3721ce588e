#include <unistd.h>

#include <csignal>

#include "tools/run.h"

namespace {

// A file that is mapped, and that another program cuts short in place, ends a program with SIGBUS.
// It says so, and ends as for other files that cannot be read (docs/conventions.md 15).
extern "C" void mapped_file_is_gone(int) {
  constexpr char kText[] =
      "panwright: error: a file was cut short while it was in use: another program writes it in "
      "place [E0102]\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kText, sizeof kText - 1);
  _exit(3);
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGBUS, mapped_file_is_gone);
  return panwright::tools::run(argc, argv);
}
