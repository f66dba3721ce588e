// What every command does around its work: diagnostics out, timings, exit code.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "base/file_uses.h"
#include "base/job.h"
#include "tools/command.h"
#include "tools/progress_line.h"
#include "tools/shared_options.h"

namespace panwright::tools {

class CommandContext {
 public:
  CommandContext(std::string command, const CommonOptions& options, const Host& host);
  ~CommandContext();

  DiagnosticLog& log() { return log_; }
  const CommonOptions& options() const { return options_; }

  // The files of this command: commands declare what they will read and write before they do.
  FileUses& files() { return *log_.files(); }

  // What libraries are given: the threads that were asked for, progress on the terminal. From the
  // first call on, a signal cancels it.
  const Job& job();

  // The object that --json prints; commands add their results to it.
  nlohmann::ordered_json& result() { return *result_; }

  // Notes that a file was written, to be said at the end, with its size and what else there is to
  // say of it ("11,880 triangles"). Streams and devices are not files.
  void wrote(const std::string& path, std::string detail = {});
  // Notes that what could be read was not written, as no output was named; to be said at the end.
  void left_out() { left_out_ = true; }

  // The command shows a pxn text, and `check` and `compile` speak of it: what the importers found
  // in its CAD files and that leaves the result as it is becomes one line (--json has it all).
  void summarise_imports() { summarises_imports_ = true; }

  // What the cache had and what was made anew: `cache` of the result, and a line of --timings.
  // whole: it had the whole file.
  void add_work(const WorkCounts& work, bool whole = false);

  // Ends the current step and starts one called `name`, for --timings.
  void step(std::string name);
  // Adds steps whose time was taken elsewhere.
  void add_timing(std::string name, double seconds);
  void add_timings(const std::vector<workspace::Step>& steps);

  // Prints diagnostics (text on standard error, or the JSON object on standard output), timings
  // and the SARIF file. Returns the exit code: what the diagnostics ask for, or `clean` without
  // errors.
  int finish(int clean = 0);

 private:
  void end_step();
  void say_what_was_written() const;
  std::string command_;
  CommonOptions options_;
  std::function<void()> watch_signals_;  // empty: done
  ProgressLine progress_;
  Job job_;
  DiagnosticLog log_;
  std::unique_ptr<nlohmann::ordered_json> result_;
  std::vector<std::pair<std::string, double>> timings_;
  std::string work_;                                          // of add_work(), in words
  std::vector<std::pair<std::string, std::string>> written_;  // path, detail
  bool left_out_ = false;
  bool summarises_imports_ = false;
  std::string step_;
  std::chrono::steady_clock::time_point step_start_;
};

}  // namespace panwright::tools
