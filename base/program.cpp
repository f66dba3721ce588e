#include "base/program.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <thread>

namespace panwright {

namespace fs = std::filesystem;

fs::path find_program(const std::string& name) {
  const char* folders = std::getenv("PATH");
  std::string_view rest = folders == nullptr ? "" : folders;
  while (!rest.empty()) {
    const auto end = std::min(rest.find(':'), rest.size());
    const fs::path path = fs::path(rest.substr(0, end)) / name;
    std::error_code ignored;
    if (end > 0 && ::access(path.c_str(), X_OK) == 0 && fs::is_regular_file(path, ignored))
      return path;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return {};
}

bool run_program(const std::vector<std::string>& words, const Job& job) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  for (const int file : {0, 1, 2})
    ::posix_spawn_file_actions_addopen(&actions, file, "/dev/null", O_RDWR, 0);
  pid_t child = 0;
  const int problem =
      ::posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (problem != 0) return false;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (job.cancelled()) ::kill(child, SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return !job.cancelled() && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace panwright
