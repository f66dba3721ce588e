// Process that turns bytes into bytes, under limits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

#include "base/job.h"

namespace panwright {

struct ProcessLimits {
  std::uint64_t memory = 0;  // bytes of address space
  double seconds = 0;        // of processor time, rounded up to whole ones
  double clock_seconds = 0;  // while this process runs
};

struct ProcessEnd {
  enum class How {
    satisfied,    // take() returned false
    exited,       // code: its exit code
    killed,       // code: the signal that ended it
    out_of_time,  // by either clock
    not_started,  // code: errno
  };
  How how = How::exited;
  int code = 0;
};

// Runs a program with one socket as its standard input and output, and no standard error. Sends it
// `input`, then the end of file, and passes the answer to `take` until that returns false or the
// program closes the socket. On return or exception, the program and its process group have ended
// without traces: no process, no file, no core image. Signals of the terminal reach only this
// process. Thread-safe; a host that ignores or reaps SIGCHLD loses only the exit code.
//
// Throws Cancelled.
ProcessEnd run_process(const std::filesystem::path& program,
                       std::span<const std::string_view> input, const ProcessLimits& limits,
                       const std::function<bool(std::string_view)>& take, const Job& job);

}  // namespace panwright
