#include <csignal>

#include "tools/run.h"

namespace {

const panwright::Job* g_job = nullptr;  // that signals cancel
volatile std::sig_atomic_t g_signal = 0;

void cancel(int signal) {
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

}  // namespace

int main(int argc, char** argv) {
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
