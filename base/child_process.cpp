#include "base/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <optional>
#include <vector>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PANWRIGHT_WIDE_ADDRESSES
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PANWRIGHT_WIDE_ADDRESSES
#endif
#endif

namespace panwright {

namespace {

constexpr int kPollSlice = 50;                  // milliseconds between looks at the job
constexpr std::size_t kReadChunk = 256u << 10;  // bytes read at once
constexpr double kEndGrace = 2;                 // seconds to end in, once the socket is closed
constexpr double kMostOfSlice = 0.5;            // seconds: a stopped process counts no more

class SocketEnd {
 public:
  explicit SocketEnd(int number) : number_(number) {}
  ~SocketEnd() { close(); }
  SocketEnd(const SocketEnd&) = delete;
  SocketEnd& operator=(const SocketEnd&) = delete;
  int number() const { return number_; }
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

// What posix_spawn is told.
class SpawnPlan {
 public:
  explicit SpawnPlan(int socket) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_adddup2(&actions_, socket, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, socket, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions_, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 34)
    // descriptors of the host that are not closed on exec
    posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
#endif
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setflags(
        &attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setpgroup(&attributes_, 0);
    sigset_t signals;
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes_, &signals);
    for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGPIPE, SIGALRM, SIGTERM, SIGCHLD, SIGXCPU})
      sigaddset(&signals, signal);
    posix_spawnattr_setsigdefault(&attributes_, &signals);
  }
  ~SpawnPlan() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;

  // errno, or 0.
  int start(const std::filesystem::path& program, pid_t& child) const {
    std::string name = program.string();
    char* arguments[] = {name.data(), nullptr};
    return posix_spawn(&child, name.c_str(), &actions_, &attributes_, arguments, environ);
  }

 private:
  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

// A child that does not outlive this.
class ChildProcess {
 public:
  explicit ChildProcess(pid_t pid) : pid_(pid) {}
  ~ChildProcess() { end(); }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // It has been sent nothing yet, so that it cannot have used much.
  void limit(const ProcessLimits& limits) const {
    const auto set = [&](auto resource, rlim_t soft, rlim_t more) {
      rlimit now{};
      if (prlimit(pid_, resource, nullptr, &now) != 0) return;
      now.rlim_cur = std::min(soft, now.rlim_max);
      now.rlim_max = std::min(soft + more, now.rlim_max);
      prlimit(pid_, resource, &now, nullptr);
    };
#ifndef PANWRIGHT_WIDE_ADDRESSES
    set(RLIMIT_AS, limits.memory, 0);
#endif
    const double seconds = std::clamp(std::ceil(limits.seconds), 1.0, 1e9);
    set(RLIMIT_CPU, static_cast<rlim_t>(seconds), 1);
    set(RLIMIT_CORE, 0, 0);
  }

  // How it ended by itself, within some seconds; nothing where it did not, or it is unknown.
  std::optional<ProcessEnd> ended(double seconds) const {
    for (double waited = 0; waited <= seconds; waited += 0.005) {
      siginfo_t info{};
      if (waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) != 0)
        return std::nullopt;
      if (info.si_pid == pid_)
        return ProcessEnd{
            info.si_code == CLD_EXITED ? ProcessEnd::How::exited : ProcessEnd::How::killed,
            info.si_status};
      poll(nullptr, 0, 5);
    }
    return std::nullopt;
  }

 private:
  // note: the group keeps its number until its leader is waited for
  void end() const {
    kill(-pid_, SIGKILL);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

  const pid_t pid_;
};

// The bytes that are still to be sent.
class ProcessInput {
 public:
  ProcessInput(std::span<const std::string_view> parts, int socket)
      : parts_(parts), socket_(socket) {}

  bool done() const { return done_; }

  // Sends what fits, and the end of file behind the last byte. A program that reads no more is
  // none of our business.
  void send_some() {
    while (!done_) {
      while (next_ < parts_.size() && at_ == parts_[next_].size()) {
        ++next_;
        at_ = 0;
      }
      if (next_ == parts_.size()) {
        shutdown(socket_, SHUT_WR);
        done_ = true;
        return;
      }
      const std::string_view part = parts_[next_].substr(at_);
      const ssize_t sent = send(socket_, part.data(), part.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent < 0 && errno == EINTR) continue;
      if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
      if (sent < 0) {
        done_ = true;
        return;
      }
      at_ += static_cast<std::size_t>(sent);
    }
  }

 private:
  const std::span<const std::string_view> parts_;
  const int socket_;
  std::size_t next_ = 0;
  std::size_t at_ = 0;
  bool done_ = false;
};

}  // namespace

ProcessEnd run_process(const std::filesystem::path& program,
                       std::span<const std::string_view> input, const ProcessLimits& limits,
                       const std::function<bool(std::string_view)>& take, const Job& job) {
  using How = ProcessEnd::How;
  using Clock = std::chrono::steady_clock;
  job.poll();
  int pair[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
    return {How::not_started, errno};
  SocketEnd socket(pair[0]);
  SocketEnd theirs(pair[1]);
  pid_t pid = 0;
  if (const int error = SpawnPlan(theirs.number()).start(program, pid); error != 0)
    return {How::not_started, error};
  const ChildProcess child(pid);
  theirs.close();
  child.limit(limits);

  ProcessInput sending(input, socket.number());
  std::vector<char> buffer(kReadChunk);
  double elapsed = 0;
  for (auto before = Clock::now();;) {
    const short events = static_cast<short>(POLLIN | (sending.done() ? 0 : POLLOUT));
    pollfd waiting{socket.number(), events, 0};
    poll(&waiting, 1, kPollSlice);
    job.poll();
    if (!sending.done()) sending.send_some();
    const ssize_t count = recv(socket.number(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    const bool nothing_yet =
        count < 0 && (errno == EINTR || errno == EAGAIN || errno == EWOULDBLOCK);
    if (count > 0 && !take({buffer.data(), static_cast<std::size_t>(count)}))
      return {How::satisfied, 0};
    if (count <= 0 && !nothing_yet) break;
    // note: neither a suspended machine nor Ctrl-Z uses up the time
    const auto now = Clock::now();
    elapsed += std::min(std::chrono::duration<double>(now - before).count(), kMostOfSlice);
    before = now;
    if (elapsed > limits.clock_seconds) return {How::out_of_time, 0};
  }
  const auto end = child.ended(kEndGrace);
  if (!end) return {How::exited, 0};
  if (end->how == How::killed && end->code == SIGXCPU) return {How::out_of_time, 0};
  return *end;
}

}  // namespace panwright
