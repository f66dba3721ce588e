// panwright-step: reads one STEP file for the importers, in a process of its own, because
// OpenCASCADE may take down the one that it is in. Request on standard input, answer on standard
// output (internal/wire.h). Started by importers/step/step.cpp alone, which also sets its limits.
#include <fcntl.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <Standard_OutOfMemory.hxx>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <string>

#include "importers/step/internal/read.h"
#include "importers/step/internal/wire.h"

namespace {

using namespace panwright;
using namespace panwright::importers;

// Diagnostics that are kept. Those of a file with more are cut short.
constexpr std::size_t kMostDiagnostics = 100'000;

bool send_all(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

std::string received() {
  std::string out;
  std::string buffer(std::size_t{1} << 20, '\0');
  for (;;) {
    const ssize_t count = read(STDIN_FILENO, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return out;
    out.append(buffer, 0, static_cast<std::size_t>(count));
  }
}

// Of the system's processes this one is the first to go when memory runs out, and it does not
// outlive the one that started it.
void be_expendable() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (file < 0) return;
  (void)!write(file, "800", 3);
  close(file);
}

// Nothing can be told any more: telling takes memory.
[[noreturn]] void give_up() { _exit(step::kOutOfMemory); }

// OpenCASCADE throws what it throws from functions that must not.
[[noreturn]] void terminated() {
  try {
    if (const auto thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const Standard_OutOfMemory&) {
    give_up();
  } catch (...) {
  }
  std::abort();
}

int answer() {
  auto bytes = std::make_shared<const std::string>(received());
  std::string_view text = *bytes;
  const auto request = step::request_from(text);
  if (!request || !send_all(step::kAnswerMark)) return 2;
  Options options;
  options.limits = request->limits;
  options.deflection = request->deflection;
  InputFile file;
  file.path = request->path;
  file.name = request->name;
  file.bytes = SharedText(std::shared_ptr<const void>(bytes), text);
  DiagnosticLog log(kMostDiagnostics);
  std::size_t sent = 0;
  const auto tell = [&] { sent = step::send_diagnostics(log, sent, send_all); };
  bool complete = false;
  try {
    const auto out = step::read_in_process(file, options, log, tell);
    tell();
    if (out) step::send_scene(*out, send_all);
    complete = out.ok();
  } catch (const Standard_OutOfMemory&) {
    give_up();
  }
  step::send_end(complete, send_all);
  return 0;
}

}  // namespace

int main(int argc, char**) {
  if (argc > 1 || isatty(STDIN_FILENO)) {
    std::fputs("panwright-step: part of panwright, which starts it to read STEP files\n", stderr);
    return 2;
  }
  be_expendable();
  std::set_new_handler(give_up);
  std::set_terminate(terminated);
  const int code = answer();
  // what OpenCASCADE would tidy up goes with the process
  _exit(code);
}
