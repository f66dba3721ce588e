#include <fcntl.h>
#include <unistd.h>

#include <csignal>

#include "tools/run.h"

namespace {

// A file that is mapped, and that another program cuts short in place, ends a program with SIGBUS.
// It says so, and ends as for other files that cannot be read (docs/conventions.md 18).
extern "C" void mapped_file_is_gone(int) {
  constexpr char kText[] =
      "panwright: error: a file was cut short while it was in use: another program writes it in "
      "place [E0102]\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kText, sizeof kText - 1);
  _exit(3);
}

const panwright::Job* g_job = nullptr;  // that signals cancel
volatile std::sig_atomic_t g_signal = 0;

extern "C" void cancel(int signal) {
  g_signal = signal;
  g_job->cancel();
}

// The first signal asks the work to stop, so that nothing half-written is left; a second one ends
// the process. What is ignored, as below nohup, stays so.
void watch_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    if (sigaction(signal, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = cancel;
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
    sigemptyset(&action.sa_mask);
    sigaction(signal, &action, nullptr);
  }
}

// Files that the program opens must not get the numbers of streams that are closed: what is printed
// would end up in them. What is written to a stream that nobody gave fails, as it did before.
void hold_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) == -1) {
      const int held = open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
      if (held >= 0 && held != stream) close(held);
    }
}

}  // namespace

int main(int argc, char** argv) {
  hold_standard_streams();
  std::signal(SIGBUS, mapped_file_is_gone);
  // a file above the limit of the shell is a write that fails, as on a full disk
  std::signal(SIGXFSZ, SIG_IGN);
  const panwright::Job job(panwright::JobOptions{});
  g_job = &job;
  const int code = panwright::tools::run(argc, argv, {job, watch_signals});
  constexpr int kCancelled = 130;
  if (code == kCancelled && g_signal != 0) {
    // what started the program learns that a signal ended it
    std::signal(g_signal, SIG_DFL);
    std::raise(g_signal);
  }
  return code;
}
