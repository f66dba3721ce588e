// Models of the window, read in the background and again when a file changes.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "base/diagnostic.h"
#include "base/file_uses.h"
#include "base/job.h"
#include "sensor/camera_file.h"
#include "workspace/targets.h"
#include "workspace/watch.h"
#include "world/world.h"

namespace panwright::studio {

struct Play;  // studio/play.h

// Diagnostic with its location, for a list.
struct Message {
  Severity severity = Severity::note;
  std::string code;
  std::string text;  // with its hint
  std::string file;  // empty: no location
  std::uint32_t line = 0;
  std::uint32_t column = 0;
};

std::vector<Message> messages_of(const DiagnosticLog& log);

// Last version of the targets, and of the scenario that names them, without an error.
class Project {
 public:
  // Begins to read. files: FILE or NAME=FILE, one of which may be a scenario. notify: called by its
  // threads when state() changes. owner: of a trajectory alone, as of open_play(). camera: file of
  // the image's camera; empty: none
  Project(std::vector<std::string> files, workspace::OpenOptions open,
          std::function<void()> notify = {}, std::string owner = {}, std::string camera = {});
  ~Project();
  Project(const Project&) = delete;
  Project& operator=(const Project&) = delete;

  struct State {
    std::shared_ptr<const world::World> world;  // the last good one; null: none yet
    std::shared_ptr<const Play> play;           // the scenario of `world`; null: there is none
    std::shared_ptr<const sensor::CameraFile> camera;  // of the file beside `world`; null: none
    std::vector<std::string> targets;                  // of `world`, FILE or NAME=FILE
    std::shared_ptr<const workspace::BoundingSpheres> spheres;  // of its targets, without poses
    std::vector<Message> messages;                              // of the last reading
    std::uint64_t readings = 0;                                 // finished
    bool reading = false;
    bool failed = false;   // the last reading had errors: `world` is an earlier version
    bool partial = false;  // `world` is incomplete, as no version without an error exists yet
    double seconds = 0;    // of the last reading
    // times of the file change that led to `world`; 0: there was none
    std::int64_t saved = 0;  // when the file was written, ns of the system's clock
    double noticed = 0;      // seconds later
    double read = 0;         // seconds from `saved` to `world`
    std::vector<std::filesystem::path> watched;
  };
  State state() const;
  const std::vector<std::string>& files() const { return files_; }
  // The files of the last reading, which no output may replace.
  std::shared_ptr<FileUses> inputs() const;

  void reload();                      // even without a change
  void add(const std::string& file);  // another target
  void set_prune(bool prune);         // workspace::OpenOptions::prune
  // Texts in place of the contents of files: workspace::OpenOptions::unsaved.
  void set_unsaved(decltype(workspace::OpenOptions::unsaved) texts);

 private:
  void watch();
  void read();
  void notice(std::int64_t saved);
  struct Reading;
  void read_once(const std::vector<std::string>& files, workspace::OpenOptions open,
                 const Job& job);
  std::optional<world::World> readable(const Reading& reading, const workspace::OpenOptions& open,
                                       const Job& job, std::set<std::filesystem::path>& inputs);
  void count_later_changes(const std::vector<workspace::FileStamp>& stamps);
  void publish(Reading reading, const Job& job);

  std::vector<std::string> files_;
  std::string owner_;
  const std::string camera_;  // file
  workspace::OpenOptions open_;
  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  State state_;
  std::vector<workspace::FileStamp> watched_;
  std::int64_t saved_ = 0;  // of the change that is pending or being read
  double noticed_ = 0;
  std::chrono::steady_clock::time_point changed_;  // time of the last change found
  std::function<void()> notify_;
  Job job_;  // of the reading in progress
  Job watching_{JobOptions{}};
  std::shared_ptr<FileUses> inputs_ = std::make_shared<FileUses>();
  bool pending_ = true;
  bool ending_ = false;
  std::thread reader_;
  std::thread watcher_;
};

}  // namespace panwright::studio
