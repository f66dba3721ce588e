#include "base/file_uses.h"

#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <compare>
#include <map>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "base/internal/write_target.h"
#include "base/text.h"

namespace panwright {

namespace {

namespace fs = std::filesystem;

using Identity = std::pair<dev_t, ino_t>;

std::optional<Identity> identity_of(const struct stat& status) {
  if (!S_ISREG(status.st_mode)) return std::nullopt;
  return Identity{status.st_dev, status.st_ino};
}

// Where a file stands or will stand: that of a file that does not exist yet has no identity.
struct Place {
  Identity folder;
  std::string name;
  auto operator<=>(const Place&) const = default;
};

struct Declared {
  std::string path;  // as typed
  std::string what;
  FileUses::Output kind = FileUses::Output::result;
  Place place;
  std::optional<Identity> identity;  // of the file that will be replaced
  bool foretold = true;              // before anything was written
  bool begun = false;
  bool refused = false;
};

// Nothing for what cannot be destroyed: open streams, devices; and for what cannot be written,
// which its writer reports.
std::optional<Declared> declared(const fs::path& path) {
  if (path.empty() || path == "-") return std::nullopt;
  Declared out;
  out.path = path.string();
  // a symbolic link keeps pointing: its target is what gets replaced
  const internal::WriteTarget target = internal::write_target(path);
  if (target.stream >= 0) return std::nullopt;
  const fs::path& real = target.path;
  struct stat status {};
  if (stat(real.c_str(), &status) == 0) {
    out.identity = identity_of(status);
    if (!out.identity) return std::nullopt;
  }
  const fs::path folder = real.has_parent_path() ? real.parent_path() : fs::path(".");
  if (stat(folder.c_str(), &status) != 0) return std::nullopt;
  out.place = {{status.st_dev, status.st_ino}, real.filename().string()};
  return out;
}

std::string named(const Declared& output) {
  return output.what.empty() ? in_quotes(output.path)
                             : fmt::format("{} {}", output.what, in_quotes(output.path));
}

}  // namespace

struct FileUses::State {
  std::mutex mutex;
  std::map<Identity, std::string> inputs;  // and the name by which each was read first
  std::vector<Identity> new_inputs;        // since outputs were last looked at
  std::vector<Declared> outputs;
  // indices of outputs; of those to be replaced
  std::multimap<Place, std::size_t> by_place;
  std::multimap<Identity, std::size_t> by_identity;
  bool stopped = false;  // an output that was declared before anything was written is refused

  void add_input(const Identity& identity, const fs::path& path) {
    if (inputs.emplace(identity, path.string()).second) new_inputs.push_back(identity);
  }

  void refuse(Declared& output) {
    output.refused = true;
    stopped = stopped || output.foretold;
  }

  void refuse_input(Declared& output, DiagnosticLog& log) {
    if (output.refused || output.begun || output.kind == Output::in_place || !output.identity)
      return;
    const auto input = inputs.find(*output.identity);
    if (input == inputs.end()) return;
    refuse(output);
    const bool renamed = input->second != output.path;
    log.report(Code("E0206"), {},
               fmt::format("{} names an input{}: it would be overwritten", named(output),
                           renamed ? " (" + in_quotes(input->second) + ")" : std::string()),
               "choose another output");
  }

  void refuse_new_inputs(DiagnosticLog& log) {
    std::vector<std::size_t> found;
    for (const Identity& input : std::exchange(new_inputs, {})) {
      const auto [begin, end] = by_identity.equal_range(input);
      for (auto each = begin; each != end; ++each) found.push_back(each->second);
    }
    std::sort(found.begin(), found.end());
    for (const std::size_t index : found) refuse_input(outputs[index], log);
  }

  // Returns the index of the first output of the same file that `counts` is true of; none: -1.
  template <class Counts>
  std::size_t same_as(const Declared& output, const Counts& counts) const {
    std::size_t found = kNone;
    const auto look = [&](const auto& range) {
      for (auto each = range.first; each != range.second; ++each)
        if (each->second < found && counts(outputs[each->second])) found = each->second;
    };
    look(by_place.equal_range(output.place));
    if (output.identity) look(by_identity.equal_range(*output.identity));
    return found;
  }

  // Returns its index.
  std::size_t add(Declared&& output, DiagnosticLog& log) {
    const std::size_t same = same_as(output, [](const Declared&) { return true; });
    if (same != kNone) {
      Declared& other = outputs[same];
      if (other.kind == Output::in_place && output.kind == Output::in_place) return same;
      log.report(Code("E0206"), {},
                 fmt::format("{} and {} are one file: one would overwrite the other", named(other),
                             named(output)),
                 "choose another output");
      refuse(output);
      if (!other.begun) refuse(other);
    }
    const std::size_t index = outputs.size();
    by_place.emplace(output.place, index);
    if (output.identity) by_identity.emplace(*output.identity, index);
    outputs.push_back(std::move(output));
    refuse_input(outputs.back(), log);
    return index;
  }

  // From here on the name of an output stands for another file.
  void begin(std::size_t index) {
    Declared& output = outputs[index];
    output.begun = true;
    if (!output.identity) return;
    const auto [begin, end] = by_identity.equal_range(*output.identity);
    by_identity.erase(
        std::find_if(begin, end, [&](const auto& each) { return each.second == index; }));
    output.identity.reset();
  }

  static constexpr std::size_t kNone = ~std::size_t{0};
};

FileUses::FileUses(Job job) : state_(std::make_unique<State>()), job_(std::move(job)) {}
FileUses::~FileUses() = default;

std::shared_ptr<FileUses> FileUses::next_run() const {
  auto next = std::make_shared<FileUses>(job_);
  const std::lock_guard lock(state_->mutex);
  next->state_->inputs = state_->inputs;
  return next;
}

bool FileUses::will_write(const fs::path& path, std::string_view what, DiagnosticLog& log,
                          Output kind) {
  // what can be known to fail after minutes of work
  std::error_code error;
  const fs::path folder = path.parent_path();
  if (kind != Output::diagnostics && !folder.empty() &&
      fs::status(folder, error).type() == fs::file_type::not_found) {
    log.report_file(Code("E0103"), path.string(),
                    "cannot write " + in_quotes(path.string()) + ": there is no folder " +
                        in_quotes(folder.string()));
    return false;
  }
  auto output = declared(path);
  if (!output) return true;
  output->what = what;
  output->kind = kind;
  const std::lock_guard lock(state_->mutex);
  const std::size_t index = state_->add(*std::move(output), log);
  return !state_->outputs[index].refused;
}

void FileUses::will_read(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return;
  const auto identity = identity_of(status);
  if (!identity) return;
  const std::lock_guard lock(state_->mutex);
  state_->add_input(*identity, path);
}

void FileUses::was_opened(int descriptor, const fs::path& path) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return;
  const auto identity = identity_of(status);
  if (!identity) return;
  const std::lock_guard lock(state_->mutex);
  state_->add_input(*identity, path);
}

bool FileUses::may_write(const fs::path& path, DiagnosticLog& log) {
  auto output = declared(path);
  if (!output) return true;
  const std::lock_guard lock(state_->mutex);
  // an output that is declared is the same file, and has not been begun
  std::size_t own = state_->same_as(*output, [](const Declared& other) { return !other.begun; });
  if (own == State::kNone) {
    output->foretold = false;
    own = state_->add(*std::move(output), log);
  }
  state_->refuse_new_inputs(log);
  Declared& mine = state_->outputs[own];
  if (mine.refused || (state_->stopped && mine.kind != Output::diagnostics)) return false;
  state_->begin(own);
  return true;
}

}  // namespace panwright
