// The models of the window: read on a thread of their own, and again when one of their files changes.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "workspace/targets.h"
#include "workspace/watch.h"
#include "world/world.h"

namespace panwright::studio {

// A diagnostic with its place, for a list.
struct Message {
  Severity severity = Severity::note;
  std::string code;
  std::string text;  // with its hint
  std::string file;  // empty: no place
  std::uint32_t line = 0;
  std::uint32_t column = 0;
};

std::vector<Message> messages_of(const DiagnosticLog& log);

// The targets as they were read last without an error.
class Project {
 public:
  // files: FILE or NAME=FILE. Reading begins at once. news: called by its threads when state() is
  // another one
  Project(std::vector<std::string> files, workspace::OpenOptions open,
          std::function<void()> news = {});
  ~Project();
  Project(const Project&) = delete;
  Project& operator=(const Project&) = delete;

  struct State {
    std::shared_ptr<const world::World> world;  // the last good one; null: none yet
    std::shared_ptr<const workspace::BoundingSpheres> spheres;  // of its targets, as they were read
    std::vector<Message> messages;              // of the last reading
    std::uint64_t readings = 0;                 // that came to an end
    bool reading = false;
    bool failed = false;   // the last reading: `world` is of an earlier one
    bool partial = false;  // or of what can be read in spite of errors: there was none before
    double seconds = 0;    // of the last reading
    // of the change of a file that led to `world`; of the first one, and of others than files: 0
    std::int64_t saved = 0;  // when the file was written, ns of the system's clock
    double noticed = 0;      // seconds later
    double read = 0;         // seconds later than `saved` the world was there
    std::vector<std::filesystem::path> watched;
  };
  State state() const;
  const std::vector<std::string>& files() const { return files_; }

  void read_again();  // whether anything changed or not
  void add(const std::string& file);  // another target
  void set_prune(bool prune);         // workspace::OpenOptions::prune
  // Texts that are read in place of what files hold: workspace::OpenOptions::unsaved.
  void set_unsaved(decltype(workspace::OpenOptions::unsaved) texts);

 private:
  using Clock = std::chrono::steady_clock;
  void watch();
  void read();
  void notice(std::int64_t saved);
  void read_once(const std::vector<std::string>& files, const workspace::OpenOptions& open,
                 const Job& job);

  std::vector<std::string> files_;
  workspace::OpenOptions open_;
  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  State state_;
  std::vector<workspace::FileStamp> watched_;
  std::int64_t saved_ = 0;  // of the change that is to be read, or is being read
  double noticed_ = 0;
  Clock::time_point changed_;  // when the watcher saw the last change
  std::function<void()> news_;
  Job job_;  // of the reading that is under way
  bool wanted_ = true;
  bool ending_ = false;
  std::thread reader_;
  std::thread watcher_;
};

}  // namespace panwright::studio
