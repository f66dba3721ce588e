// A program that is given bytes and answers with bytes, under limits. Private to importers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

#include "base/job.h"

namespace panwright::importers::step {

struct ProcessLimits {
  std::uint64_t memory = 0;  // bytes of address space
  double seconds = 0;        // of processor time, rounded up to whole ones
  double clock_seconds = 0;  // while this process runs
};

struct ProcessEnd {
  enum class How {
    satisfied,    // take() wanted no more
    exited,       // code: its exit code
    killed,       // code: the signal that ended it
    out_of_time,  // by either clock
    not_started,  // code: errno
  };
  How how = How::exited;
  int code = 0;
};

// Runs a program with one socket as its standard input and output and nothing as its standard
// error: sends it `input`, then the end of file, and hands what comes back to `take` until that
// returns false or the program closes the socket. When this returns or throws, the program and
// those that it started in its process group have ended, and nothing of them is left: no process,
// no file, no core image. Signals of the terminal reach this process alone. Safe to be called by
// several threads at once; a host that ignores or reaps SIGCHLD costs the exit code alone.
//
// Throws Cancelled.
ProcessEnd run_process(const std::filesystem::path& program,
                       std::span<const std::string_view> input, const ProcessLimits& limits,
                       const std::function<bool(std::string_view)>& take, const Job& job);

}  // namespace panwright::importers::step
