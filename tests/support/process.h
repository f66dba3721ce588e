// Child processes and their output.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace panwright::support {

struct Outcome {
  int code = -1;  // exit code; 128 + signal when killed
  std::string out;
  std::string err;
};

// Runs a program with arguments, to its end. environment: NAME=VALUE entries added to ours; NAME
// removes one. PANWRIGHT_CACHE is off unless given.
Outcome run(const std::vector<std::string>& words,
            const std::vector<std::string>& environment = {});

// run() of this build's panwright.
Outcome panwright(std::vector<std::string> words, const std::vector<std::string>& environment = {});

// Starts a program, kills it after some microseconds (SIGKILL), and waits for it. Returns true if
// it was still running then.
bool run_and_kill(const std::vector<std::string>& words, unsigned microseconds);
// The same, once a condition holds that is asked every millisecond.
bool run_and_kill(const std::vector<std::string>& words, const std::function<bool()>& when);

// Starts a program, sends it a signal after some microseconds, and waits for its end.
Outcome run_and_signal(const std::vector<std::string>& words, int signal, unsigned microseconds);
// The same, once a condition on its standard output so far holds, asked every few milliseconds.
Outcome run_and_signal(const std::vector<std::string>& words, int signal,
                       const std::function<bool(const std::string& out)>& when);

// Runs a script of bash where a folder is a disk of its own, in memory. words: its $0, $1, …
//
// Returns none where this process may mount nothing.
std::optional<Outcome> run_on_disk(const std::string& folder, unsigned kilobytes,
                                   const std::string& script,
                                   const std::vector<std::string>& words);

// A folder that exists as long as this does.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

std::string contents(const std::filesystem::path& path);

}  // namespace panwright::support
