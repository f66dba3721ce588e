// The files of one run by identity, so that no output destroys an input or another output.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "base/diagnostic.h"

namespace panwright {

// A run's host makes one and gives it to the run's log (DiagnosticLog::set_files); from then on
// every file that is read or written with that log is known here. Files are the same where the file
// system says so: other spellings, symbolic and hard links count. Devices and pipes are no files.
// May be used from several threads.
class FileUses {
 public:
  enum class Output {
    result,
    in_place,     // may replace an input, by what its command is for
    diagnostics,  // is written even where another output is refused
  };

  FileUses();
  ~FileUses();

  // A copy that knows the inputs and no outputs: for the next of several runs of one process.
  std::shared_ptr<FileUses> next_run() const;

  // Declares an output before anything is read or written. what: the option it was given by, or
  // other words for it; "" for none. "-" is standard output, which nothing can destroy.
  // Fails: E0206, where it is an input or another output.
  bool will_write(const std::filesystem::path& path, std::string_view what, DiagnosticLog& log,
                  Output kind = Output::result);

  // Declares an input that will be read. What is not there is left to its reader.
  void will_read(const std::filesystem::path& path);

  // Called by what opens files (base/file.h).
  void was_opened(int descriptor, const std::filesystem::path& path);

  // Called before a file is created. Declares it, if nobody did. False: it must not be written,
  // or, once reported, another declared output must not (so that a run writes all or nothing).
  // Fails: E0206.
  bool may_write(const std::filesystem::path& path, DiagnosticLog& log);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace panwright
