#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string_view>

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

// Starts commands that draw again with an allocator that asks for large pages, and that keeps what
// is freed: software contexts take hundreds of megabytes, where small pages cost a fault each, and
// fresh ones are cleared. So an image is drawn in memory that its model was read in. The allocator
// reads the settings at the start of a process alone; as keep_freed_memory() of the contexts.
void use_large_pages([[maybe_unused]] int argc, [[maybe_unused]] char** argv) {
#ifdef __GLIBC__
  constexpr const char* kVariable = "GLIBC_TUNABLES";
  constexpr const char* kSetting =
      "glibc.malloc.hugetlb=1:glibc.malloc.mmap_threshold=134217728:"
      "glibc.malloc.trim_threshold=268435456";
  constexpr std::string_view kDraw[] = {"render", "run", "dataset", "serve"};
  if (const char* set = std::getenv(kVariable)) {
    // of the first start, and not for the programs that this one starts; a user's own stays
    if (std::string_view(set) == kSetting) unsetenv(kVariable);
    return;
  }
  if (argc < 2 || std::ranges::find(kDraw, std::string_view(argv[1])) == std::end(kDraw)) return;
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  // not a loader or an emulator
  if (error || !program.filename().string().starts_with("panwright")) return;
  setenv(kVariable, kSetting, 1);
  execv(program.c_str(), argv);
  unsetenv(kVariable);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  use_large_pages(argc, argv);
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
