#include "base/file_uses.h"

#include <fmt/core.h>
#include <sys/stat.h>

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
  bool operator==(const Place&) const = default;
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

bool same_file(const Declared& a, const Declared& b) {
  return a.place == b.place || (a.identity && a.identity == b.identity);
}

std::string named(const Declared& output) {
  return output.what.empty() ? in_quotes(output.path)
                             : fmt::format("{} {}", output.what, in_quotes(output.path));
}

}  // namespace

struct FileUses::State {
  std::mutex mutex;
  std::map<Identity, std::string> inputs;  // and the name by which each was read first
  std::vector<Declared> outputs;

  void refuse_input(Declared& output, DiagnosticLog& log) const {
    if (output.refused || output.begun || output.kind == Output::in_place || !output.identity)
      return;
    const auto input = inputs.find(*output.identity);
    if (input == inputs.end()) return;
    output.refused = true;
    const bool renamed = input->second != output.path;
    log.report(Code("E0206"), {},
               fmt::format("{} names an input{}: it would be overwritten", named(output),
                           renamed ? " (" + in_quotes(input->second) + ")" : std::string()),
               "choose another output");
  }

  // Returns its index.
  std::size_t add(Declared&& output, DiagnosticLog& log) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      Declared& other = outputs[i];
      if (same_file(other, output)) {
        if (other.kind == Output::in_place && output.kind == Output::in_place) return i;
        log.report(Code("E0206"), {},
                   fmt::format("{} and {} are one file: one would overwrite the other",
                               named(other), named(output)),
                   "choose another output");
        output.refused = true;
        other.refused = !other.begun;
        break;
      }
    }
    outputs.push_back(std::move(output));
    refuse_input(outputs.back(), log);
    return outputs.size() - 1;
  }
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
  state_->inputs.emplace(*identity, path.string());
}

void FileUses::was_opened(int descriptor, const fs::path& path) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return;
  const auto identity = identity_of(status);
  if (!identity) return;
  const std::lock_guard lock(state_->mutex);
  state_->inputs.emplace(*identity, path.string());
}

bool FileUses::may_write(const fs::path& path, DiagnosticLog& log) {
  auto output = declared(path);
  if (!output) return true;
  const std::lock_guard lock(state_->mutex);
  // an output that is declared is the same file, and has not been begun
  std::optional<std::size_t> own;
  for (std::size_t i = 0; i < state_->outputs.size() && !own; ++i) {
    const Declared& other = state_->outputs[i];
    if (!other.begun && same_file(other, *output)) own = i;
  }
  if (!own) {
    output->foretold = false;
    own = state_->add(*std::move(output), log);
  }
  bool all = true;
  for (Declared& each : state_->outputs) {
    state_->refuse_input(each, log);
    all = all && !(each.refused && each.foretold);
  }
  Declared& mine = state_->outputs[*own];
  if (mine.refused || (!all && mine.kind != Output::diagnostics)) return false;
  mine.begun = true;
  // from here on its name stands for another file
  mine.identity.reset();
  return true;
}

}  // namespace panwright
