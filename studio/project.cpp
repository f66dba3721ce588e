#include "studio/project.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>
#include <set>
#include <utility>

#include "base/clock.h"

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
                 std::function<void()> notify)
    : files_(std::move(files)), open_(std::move(open)), notify_(std::move(notify)) {
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

void Project::read_once(const std::vector<std::string>& files, const workspace::OpenOptions& open,
                        const Job& job) {
  const auto start = std::chrono::steady_clock::now();
  // before reading, so that later changes are found
  std::vector<workspace::FileStamp> stamps;
  std::vector<workspace::TargetFile> targets;
  std::set<std::filesystem::path> paths;
  for (const std::string& file : files) {
    targets.push_back(workspace::target_file(file));
    paths.insert(targets.back().file);
  }
  DiagnosticLog log(200);
  log.set_files(std::make_shared<FileUses>(job));
  {
    const std::lock_guard lock(mutex_);
    for (const workspace::FileStamp& each : watched_) paths.insert(each.path);
    inputs_ = log.files();
  }
  for (const std::filesystem::path& path : paths) stamps.push_back(workspace::stamp_of(path));
  auto world = opened(targets, open, log, job);
  log.sort_by_place();
  const bool foreign = std::none_of(targets.begin(), targets.end(), is_pxn);
  // without an earlier version, the targets that can be read stand for all
  std::optional<world::World> some;
  std::vector<workspace::TargetFile> good;
  if ((!world || log.has_errors()) && targets.size() > 1 && !state().world) {
    for (const workspace::TargetFile& each : targets) {
      DiagnosticLog alone = log.apart();
      const std::vector<workspace::TargetFile> one{each};
      if (opened(one, open, alone, job) && (!alone.has_errors() || !is_pxn(each)))
        good.push_back(each);
    }
    DiagnosticLog ignored = log.apart();
    if (!good.empty())
      if (auto part = opened(good, open, ignored, job)) some = *std::move(part);
  }
  // included files: known from good models, and from diagnostics
  std::set<std::filesystem::path> more;
  if (world) add_inputs(*world, targets, more);
  if (some) add_inputs(*some, good, more);
  workspace::add_sources(log, more);
  for (const std::filesystem::path& path : more)
    if (paths.insert(path).second) stamps.push_back(workspace::stamp_of(path));

  const bool bad = !world || log.has_errors();
  // computed here, as large models take long
  auto spheres = std::make_shared<workspace::BoundingSpheres>();
  if (world)
    spheres->of(*world);
  else if (some)
    spheres->of(*some);
  std::unique_lock lock(mutex_);
  // half-written files: wait for the rest
  if (bad) wake_.wait_until(lock, changed_ + kSettle, [&] { return pending_ || ending_; });
  if (job.cancelled() || (bad && pending_)) return;
  watched_ = std::move(stamps);
  state_.messages = messages_of(log);
  state_.failed = bad;
  if (!bad) {
    state_.saved = saved_;
    state_.noticed = noticed_;
    state_.read = saved_ == 0 ? 0 : seconds_since_saved(saved_);
    state_.world = std::make_shared<const world::World>(*std::move(world));
    state_.partial = false;
  } else if (world && foreign && (!state_.world || state_.partial)) {
    // CAD files are drawn in spite of errors where possible
    state_.world = std::make_shared<const world::World>(*std::move(world));
    state_.partial = true;
  } else if (some) {
    state_.world = std::make_shared<const world::World>(*std::move(some));
    state_.partial = true;
  }
  if (world || some) state_.spheres = std::move(spheres);
  ++state_.readings;
  state_.seconds = seconds_since(start);
  state_.watched.clear();
  for (const workspace::FileStamp& each : watched_) state_.watched.push_back(each.path);
}

}  // namespace panwright::studio
