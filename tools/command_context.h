// Common frame of every command: diagnostics, timings, exit code.
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

  // The files of this command: inputs and outputs are declared before use.
  FileUses& files() { return *log_.files(); }

  // Returns the job for libraries: the requested threads, and progress on the terminal. From the
  // first call on, a signal cancels it.
  const Job& job();

  // The object printed by --json; commands add their results to it.
  nlohmann::ordered_json& result() { return *result_; }

  // Records a written file, reported at the end with its size and details ("11,880 triangles").
  // Streams and devices are not files.
  void wrote(const std::string& path, std::string detail = {});
  // Why the readable part of an input is not written: no output was named, or terrain is part of
  // it, which is tiled as a whole.
  enum class LeftOut { unnamed, terrain };
  // Records that it is not; reported at the end.
  void left_out(LeftOut why) { left_out_ = why; }

  // Summarises the importers' harmless diagnostics about CAD files in one line (--json has all);
  // for commands that show a pxn text, as `check` and `compile` report them.
  void summarise_imports() { summarises_imports_ = true; }

  // Leaves notes of a code out of what people read (--json has all).
  void leave_out(Code code) { left_out_codes_.push_back(code); }

  // Adds the cache's statistics: `cache` of the result, and a line of --timings.
  void add_work(const WorkCounts& work);

  // Ends the current step and starts one named `name`, for --timings.
  void step(std::string name);
  // Adds steps timed elsewhere.
  void add_timing(std::string name, double seconds);
  void add_timings(const std::vector<workspace::Step>& steps);

  // Prints diagnostics (text on standard error, or the JSON object on standard output), timings and
  // the SARIF file. Returns the exit code: that of the diagnostics, or `clean` without errors.
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
  std::optional<LeftOut> left_out_;
  bool summarises_imports_ = false;
  std::vector<Code> left_out_codes_;
  std::string step_;
  std::chrono::steady_clock::time_point step_start_;
};

}  // namespace panwright::tools
