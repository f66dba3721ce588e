#include "studio/project.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>
#include <set>
#include <utility>

#include "base/clock.h"
#include "base/file.h"
#include "base/text.h"
#include "studio/play.h"
#include "workspace/scenario.h"

namespace panwright::studio {
namespace {

using namespace std::chrono_literals;

constexpr auto kWatchPeriod = 10ms;
// Errors are reported after this time without a change: editors write in several steps.
constexpr auto kSettle = 30ms;
// Larger files are read after that time without a change, too.
constexpr std::int64_t kSmall = 4 << 20;  // bytes

// saved: nanoseconds of the system clock
double seconds_since_saved(std::int64_t saved) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return 1e-9 * static_cast<double>(
                    std::chrono::duration_cast<std::chrono::nanoseconds>(now).count() - saved);
}

// Errors of a text can be corrected by its author; those of CAD files often cannot.
bool is_pxn(const workspace::TargetFile& target) {
  return workspace::extension_of(target.file) == ".pxn";
}

bool is_scenario(const std::string& file) {
  return workspace::is_scenario(workspace::target_file(file).file);
}

// As workspace::open_world(), also without memory for it.
Result<world::World> opened(const std::vector<workspace::TargetFile>& targets,
                            const workspace::OpenOptions& open, DiagnosticLog& log,
                            const Job& job) {
  try {
    return workspace::open_world(targets, open, log, job);
  } catch (const std::exception&) {
    report_exception(log);
    return failed;
  }
}

void add_inputs(const world::World& world, const std::vector<workspace::TargetFile>& targets,
                std::set<std::filesystem::path>& files) {
  for (std::size_t i = 0; i < world.size(); ++i)
    workspace::add_inputs(*world[i].model(), targets[i].file, files);
}

}  // namespace

std::vector<Message> messages_of(const DiagnosticLog& log) {
  std::vector<Message> out;
  for (const Diagnostic& each : log.entries()) {
    Message message;
    message.severity = each.severity();
    message.code = code_info(each.code).name;
    message.text = each.message;
    if (!each.hint.empty()) message.text += "; " + each.hint;
    if (each.where.file != kNoFile) {
      message.file = log.sources().file(each.where.file).name;
      // an error of a file as a whole has no location
      if (each.where.end > 0) {
        const Position at = log.sources().position(each.where.file, each.where.begin);
        message.line = at.line;
        message.column = at.column;
      }
    }
    out.push_back(std::move(message));
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Message& a, const Message& b) { return a.severity > b.severity; });
  if (log.hidden() > 0)
    out.push_back({Severity::note, "", fmt::format("and {} more", log.hidden()), "", 0, 0});
  return out;
}

Project::Project(std::vector<std::string> files, workspace::OpenOptions open,
                 std::function<void()> notify, std::string owner, std::string camera)
    : files_(std::move(files)),
      owner_(std::move(owner)),
      camera_(std::move(camera)),
      open_(std::move(open)),
      notify_(std::move(notify)) {
  state_.reading = true;
  reader_ = std::thread([this] { read(); });
  watcher_ = std::thread([this] { watch(); });
}

Project::~Project() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    watching_.cancel();
    if (job_.state()) job_.cancel();
  }
  wake_.notify_all();
  reader_.join();
  watcher_.join();
}

Project::State Project::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

std::shared_ptr<FileUses> Project::inputs() const {
  const std::lock_guard lock(mutex_);
  auto inputs = inputs_->next_run();
  for (const std::string& file : files_) inputs->will_read(workspace::target_file(file).file);
  if (!camera_.empty()) inputs->will_read(camera_);
  for (const std::filesystem::path& file : state_.watched) inputs->will_read(file);
  return inputs;
}

void Project::reload() {
  {
    const std::lock_guard lock(mutex_);
    notice(0);
  }
  wake_.notify_all();
}

// Expects: the lock.
void Project::notice(std::int64_t saved) {
  saved_ = saved;
  noticed_ = saved == 0 ? 0 : seconds_since_saved(saved);
  pending_ = true;
  state_.reading = true;
  if (job_.state()) job_.cancel();
}

void Project::add(const std::string& file) {
  {
    const std::lock_guard lock(mutex_);
    // a scenario takes the place of another
    if (is_scenario(file)) std::erase_if(files_, is_scenario);
    files_.push_back(file);
  }
  reload();
}

void Project::set_prune(bool prune) {
  {
    const std::lock_guard lock(mutex_);
    if (open_.prune == prune) return;
    open_.prune = prune;
  }
  reload();
}

void Project::set_unsaved(decltype(workspace::OpenOptions::unsaved) texts) {
  {
    const std::lock_guard lock(mutex_);
    const auto same = [](const auto& a, const auto& b) {
      return a.first == b.first && *a.second == *b.second;
    };
    if (std::equal(texts.begin(), texts.end(), open_.unsaved.begin(), open_.unsaved.end(), same))
      return;
    open_.unsaved = std::move(texts);
  }
  reload();
}

void Project::watch() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kWatchPeriod, [&] { return ending_; })) {
    const std::vector<workspace::FileStamp> known = watched_;
    lock.unlock();
    std::vector<workspace::FileStamp> now = workspace::stamps_of(known);
    if (now == known) {
      lock.lock();
      continue;
    }
    std::int64_t saved = 0;
    bool large = false;
    for (std::size_t i = 0; i < now.size(); ++i)
      if (now[i] != known[i]) {
        saved = std::max(saved, now[i].time);
        large = large || now[i].size > kSmall;
      }
    if (large) workspace::wait_until_still(now, watching_);
    lock.lock();
    if (watched_ != known) continue;
    watched_ = std::move(now);
    changed_ = std::chrono::steady_clock::now();
    notice(saved);
    wake_.notify_all();
    if (notify_) notify_();
  }
}

void Project::read() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [&] { return pending_ || ending_; });
    if (ending_) return;
    pending_ = false;
    state_.reading = true;
    job_ = Job(JobOptions{});
    const Job job = job_;
    const std::vector<std::string> files = files_;
    const workspace::OpenOptions open = open_;
    lock.unlock();
    read_once(files, open, job);
    lock.lock();
    job_ = Job();
    state_.reading = pending_;
    if (notify_) notify_();
  }
}

// One reading of the files.
struct Project::Reading {
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  DiagnosticLog log{200};
  std::vector<workspace::FileStamp>
      stamps;                  // taken before reading, so that later changes are found
  std::shared_ptr<Play> play;  // null: no scenario, or a bad one
  std::shared_ptr<const sensor::CameraFile> camera;  // null: none, a bad one, or the scenario's
  std::vector<std::string> names;                    // of the targets, FILE or NAME=FILE
  std::vector<workspace::TargetFile> targets;
  std::optional<world::World> world;
  std::optional<world::World> some;  // of the targets that can be read, where not all can be

  void stamp(const std::set<std::filesystem::path>& paths) {
    for (const std::filesystem::path& path : paths)
      if (stamped_.insert(path).second) stamps.push_back(workspace::stamp_of(path));
  }

  // Opens the scenario, if there is one, and finds the targets. False: see the log.
  bool find_targets(const std::vector<std::string>& files, const std::string& owner,
                    const std::string& camera_file) {
    std::vector<std::string> scenarios;
    for (const std::string& file : files) (is_scenario(file) ? scenarios : names).push_back(file);
    if (scenarios.size() > 1) {
      log.report(Code("E0201"), {},
                 fmt::format("{} and {} are two scenarios; the window plays one",
                             in_quotes(scenarios[0]), in_quotes(scenarios[1])));
      return false;
    }
    if (!scenarios.empty()) {
      auto opened = open_play(scenarios[0], owner, names, camera_file, log);
      if (!opened) return false;
      play = std::make_shared<Play>(*std::move(opened));
      names = play->targets;
    } else if (!camera_file.empty() && !read_camera(camera_file)) {
      return false;
    }
    for (const std::string& name : names) targets.push_back(workspace::target_file(name));
    return true;
  }

 private:
  bool read_camera(const std::string& file) {
    constexpr std::uint64_t kMostBytes = 1 << 20;
    const auto text = read_file(file, kMostBytes, log);
    if (!text) return false;
    auto read = sensor::read_camera(*text, file, log);
    if (read) camera = std::make_shared<const sensor::CameraFile>(*std::move(read));
    return bool(read);
  }

  std::set<std::filesystem::path> stamped_;
};

void Project::read_once(const std::vector<std::string>& files, workspace::OpenOptions open,
                        const Job& job) {
  Reading reading;
  DiagnosticLog& log = reading.log;
  log.set_files(std::make_shared<FileUses>(job));
  std::set<std::filesystem::path> paths;
  for (const std::string& file : files) paths.insert(workspace::target_file(file).file);
  if (!camera_.empty()) paths.insert(camera_);
  std::string owner;
  {
    const std::lock_guard lock(mutex_);
    for (const workspace::FileStamp& each : watched_) paths.insert(each.path);
    inputs_ = log.files();
    owner = owner_;
  }
  reading.stamp(paths);
  std::set<std::filesystem::path> inputs;
  if (reading.find_targets(files, owner, camera_)) {
    paths.clear();
    for (const workspace::TargetFile& target : reading.targets) paths.insert(target.file);
    reading.stamp(paths);
    if (reading.play && open.parameters.empty())
      open.parameters = *reading.play->scenario.settings.define;
    if (auto world = opened(reading.targets, open, log, job)) reading.world = *std::move(world);
    if (reading.play && reading.world && !log.has_errors())
      find_tracks(*reading.play, *reading.world, log);
    if (!reading.play) reading.some = readable(reading, open, job, inputs);
  }
  log.sort_by_place();
  // included files: known from good models and scenarios, and from diagnostics
  if (reading.world) add_inputs(*reading.world, reading.targets, inputs);
  if (reading.play) {
    const workspace::Scenario& scenario = reading.play->scenario;
    inputs.insert(scenario.files.begin(), scenario.files.end());
    if (scenario.settings.camera_file) inputs.insert(*scenario.settings.camera_file);
  }
  workspace::add_sources(log, inputs);
  reading.stamp(inputs);
  publish(std::move(reading), job);
}

// Without an earlier version, the targets that can be read stand for all.
std::optional<world::World> Project::readable(const Reading& reading,
                                              const workspace::OpenOptions& open, const Job& job,
                                              std::set<std::filesystem::path>& inputs) {
  const bool bad = !reading.world || reading.log.has_errors();
  if (!bad || reading.targets.size() < 2 || state().world) return std::nullopt;
  std::vector<workspace::TargetFile> good;
  for (const workspace::TargetFile& each : reading.targets) {
    DiagnosticLog alone = reading.log.apart();
    const std::vector<workspace::TargetFile> one{each};
    if (opened(one, open, alone, job) && (!alone.has_errors() || !is_pxn(each)))
      good.push_back(each);
  }
  if (good.empty()) return std::nullopt;
  DiagnosticLog ignored = reading.log.apart();
  auto part = opened(good, open, ignored, job);
  if (!part) return std::nullopt;
  add_inputs(*part, good, inputs);
  return *std::move(part);
}

// A file may be written again between its notice and its reading: the last change counts.
void Project::count_later_changes(const std::vector<workspace::FileStamp>& stamps) {
  if (saved_ == 0) return;
  std::int64_t last = saved_;
  for (const workspace::FileStamp& now : stamps)
    for (const workspace::FileStamp& known : watched_)
      if (known.path == now.path && known != now) last = std::max(last, now.time);
  noticed_ = std::max(0.0, noticed_ - 1e-9 * static_cast<double>(last - saved_));
  saved_ = last;
}

void Project::publish(Reading reading, const Job& job) {
  const DiagnosticLog& log = reading.log;
  const bool bad = !reading.world || log.has_errors();
  const bool foreign = std::none_of(reading.targets.begin(), reading.targets.end(), is_pxn);
  // computed here, as large models take long
  auto spheres = std::make_shared<workspace::BoundingSpheres>();
  if (reading.world)
    spheres->of(*reading.world);
  else if (reading.some)
    spheres->of(*reading.some);
  std::unique_lock lock(mutex_);
  // half-written files: wait for the rest
  if (bad) wake_.wait_until(lock, changed_ + kSettle, [&] { return pending_ || ending_; });
  if (job.cancelled() || (bad && pending_)) return;
  count_later_changes(reading.stamps);
  watched_ = std::move(reading.stamps);
  state_.messages = messages_of(log);
  state_.failed = bad;
  const auto take = [&](std::optional<world::World>& world) {
    state_.world = std::make_shared<const world::World>(*std::move(world));
    state_.spheres = std::move(spheres);
    state_.partial = bad;
    state_.play = bad ? nullptr : std::move(reading.play);
    state_.camera = std::move(reading.camera);
    state_.targets = std::move(reading.names);
  };
  if (!bad) {
    state_.saved = saved_;
    state_.noticed = noticed_;
    state_.read = saved_ == 0 ? 0 : seconds_since_saved(saved_);
    take(reading.world);
  } else if (reading.world && foreign && !reading.play && (!state_.world || state_.partial)) {
    // CAD files are drawn in spite of errors where possible
    take(reading.world);
  } else if (reading.some) {
    take(reading.some);
  }
  ++state_.readings;
  state_.seconds = seconds_since(reading.start);
  state_.watched.clear();
  for (const workspace::FileStamp& each : watched_) state_.watched.push_back(each.path);
}

}  // namespace panwright::studio
