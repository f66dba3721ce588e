// Identities of the files of one run, so that no output destroys an input or another output.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "base/diagnostic.h"
#include "base/job.h"

namespace panwright {

// Registry of files, made by a run's host and given to its log (DiagnosticLog::set_files), which
// then records every file read or written. Files are equal where the file system says so: other
// spellings, symbolic and hard links count. Devices and pipes are no files. Thread-safe.
class FileUses {
 public:
  enum class Output {
    result,
    in_place,     // may replace an input, by its command's purpose
    diagnostics,  // is written even where another output is refused
  };

  // job: of the run; cancelling it ends the wait for a pipe without a writer.
  explicit FileUses(Job job = {});
  ~FileUses();

  bool cancelled() const noexcept { return job_.cancelled(); }

  // Returns a copy with the inputs and no outputs, for the next run of one process.
  std::shared_ptr<FileUses> next_run() const;

  // Declares an output before anything is read or written. what: the option that gives it, or a
  // description; "" for none. "-" is standard output, which nothing can destroy.
  // Fails: E0206, where it is an input or another output.
  bool will_write(const std::filesystem::path& path, std::string_view what, DiagnosticLog& log,
                  Output kind = Output::result);

  // Declares an input that will be read. A missing file is left to its reader.
  void will_read(const std::filesystem::path& path);

  // Records an opened file (called by base/file.h).
  void was_opened(int descriptor, const std::filesystem::path& path);

  // Declares a file before it is created, unless declared. False: it, or another declared output,
  // must not be written, so that a run writes all or nothing.
  // Fails: E0206.
  bool may_write(const std::filesystem::path& path, DiagnosticLog& log);

 private:
  struct State;
  std::unique_ptr<State> state_;
  Job job_;
};

}  // namespace panwright
