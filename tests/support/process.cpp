#include "tests/support/process.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <stdexcept>

#include "tests/support/paths.h"

namespace panwright::support {

namespace {

pid_t start(const std::vector<std::string>& words, const std::vector<std::string>& environment,
            const std::string& out, const std::string& err) {
  const pid_t child = fork();
  if (child != 0) return child;
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  dup2(open(out.c_str(), flags, 0600), STDOUT_FILENO);
  dup2(open(err.c_str(), flags, 0600), STDERR_FILENO);
  // tests in the background of a shell would pass on that signals are ignored
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) signal(number, SIG_DFL);
  // what a test finds is not what an earlier one left in the user's own cache
  setenv("PANWRIGHT_CACHE", "off", 1);
  for (const std::string& entry : environment) putenv(const_cast<char*>(entry.c_str()));
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  execvp(argv[0], argv.data());
  _exit(127);
}

int code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

}  // namespace

Outcome run(const std::vector<std::string>& words, const std::vector<std::string>& environment) {
  const TemporaryFolder folder;
  const pid_t child = start(words, environment, folder / "out", folder / "err");
  if (child < 0) throw std::runtime_error("cannot fork");
  int status = 0;
  waitpid(child, &status, 0);
  return {code_of(status), contents(folder / "out"), contents(folder / "err")};
}

Outcome panwright(std::vector<std::string> words, const std::vector<std::string>& environment) {
  words.insert(words.begin(), PANWRIGHT_BIN_DIR "/panwright");
  return run(words, environment);
}

bool run_and_kill(const std::vector<std::string>& words, unsigned microseconds) {
  const pid_t child = start(words, {}, "/dev/null", "/dev/null");
  if (child < 0) throw std::runtime_error("cannot fork");
  usleep(microseconds);
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status);
}

bool run_and_kill(const std::vector<std::string>& words, const std::function<bool()>& when) {
  const pid_t child = start(words, {}, "/dev/null", "/dev/null");
  if (child < 0) throw std::runtime_error("cannot fork");
  int status = 0;
  while (!when()) {
    if (waitpid(child, &status, WNOHANG) == child) return false;
    usleep(1000);
  }
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  return WIFSIGNALED(status);
}

std::optional<Outcome> run_on_disk(const std::string& folder, unsigned kilobytes,
                                   const std::string& script,
                                   const std::vector<std::string>& words) {
  constexpr int kNoMount = 77;
  // a user namespace needs no privilege where the kernel allows it; root needs none
  std::vector<std::string> all = {"unshare", geteuid() == 0 ? "-m" : "-rm", "bash", "-c"};
  const std::string mount = "mount -t tmpfs -o size=" + std::to_string(kilobytes) + "k none '" +
                            folder + "' || exit " + std::to_string(kNoMount) + "; ";
  all.push_back(mount + script);
  all.insert(all.end(), words.begin(), words.end());
  Outcome out = run(all);
  if (out.code == kNoMount || out.err.starts_with("unshare:")) return {};
  return out;
}

Outcome run_and_signal(const std::vector<std::string>& words, int signal, unsigned microseconds) {
  const auto start = std::chrono::steady_clock::now();
  return run_and_signal(words, signal, [&](const std::string&) {
    return std::chrono::steady_clock::now() - start >= std::chrono::microseconds(microseconds);
  });
}

Outcome run_and_signal(const std::vector<std::string>& words, int signal,
                       const std::function<bool(const std::string& out)>& when) {
  const TemporaryFolder folder;
  const pid_t child = start(words, {}, folder / "out", folder / "err");
  if (child < 0) throw std::runtime_error("cannot fork");
  int status = 0;
  bool ended = false;
  while (!ended && !when(contents(folder / "out"))) {
    ended = waitpid(child, &status, WNOHANG) == child;
    usleep(5000);
  }
  if (!ended) {
    kill(child, signal);
    waitpid(child, &status, 0);
  }
  return {code_of(status), contents(folder / "out"), contents(folder / "err")};
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "panwright-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& text) const {
  std::filesystem::create_directories((path_ / name).parent_path());
  std::ofstream(path_ / name, std::ios::binary) << text;
  return (path_ / name).string();
}

std::string contents(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace panwright::support
