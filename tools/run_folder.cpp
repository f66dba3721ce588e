#include "tools/run_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "base/text.h"
#include "image/whole.h"
#include "labels/frame_files.h"

namespace panwright::tools {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostManifestBytes = 8ull << 30;
constexpr std::string_view kFrames = "frames.jsonl", kSettingsFile = "run.json";

fs::path lock_of(const fs::path& folder) { return folder / ".run.lock"; }

// The file that a name "FILE.PROCESS-NUMBER" of base/file.h would have got.
std::optional<std::string> unfinished(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  const std::size_t dash = name.rfind('-');
  if (dot == name.npos || dash == name.npos || dash < dot + 2 || dash + 1 == name.size())
    return std::nullopt;
  for (std::size_t k = dot + 1; k < name.size(); ++k)
    if (k != dash && !(name[k] >= '0' && name[k] <= '9')) return std::nullopt;
  return name.substr(0, dot);
}

}  // namespace

void remove_unfinished_files(const fs::path& folder, const std::set<std::string>& files) {
  std::error_code error;
  std::vector<fs::path> left;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const auto of = unfinished(at->path().filename().string());
    if (of && files.contains(*of)) left.push_back(at->path());
  }
  for (const fs::path& file : left) fs::remove(file, error);
}

RunFolder::RunFolder(fs::path path, std::vector<std::string> types,
                     std::shared_ptr<const workspace::Labelling> labelling)
    : path_(std::move(path)), types_(std::move(types)), labelling_(std::move(labelling)) {}

RunFolder::~RunFolder() {
  if (lock_ < 0) return;
  std::error_code ignored;
  fs::remove(lock_of(path_), ignored);
  ::close(lock_);
}

std::vector<std::string> RunFolder::outputs_of(const std::string& stem) const {
  std::vector<std::string> out;
  for (const std::string& type : types_) out.push_back(stem + "." + type);
  return out;
}

std::string RunFolder::labels_of(const std::string& stem) const {
  return stem + std::string(labels::kLabelsExtension);
}

std::vector<std::string> RunFolder::files_of(const std::string& stem) const {
  std::vector<std::string> out = outputs_of(stem);
  if (labelling_ == nullptr) return out;
  for (const std::string_view extension : {labels::kLabelsExtension, labels::kMasksExtension})
    out.push_back(stem + std::string(extension));
  if (labelling_->flow)
    for (const std::string_view extension : {labels::kForwardExtension, labels::kBackwardExtension})
      out.push_back(stem + std::string(extension));
  return out;
}

bool RunFolder::refuse(const std::string& message, const std::string& hint,
                       DiagnosticLog& log) const {
  log.report_file(Code("E8014"), path_.string(), message, hint);
  return false;
}

bool RunFolder::take(DiagnosticLog& log) {
  std::error_code error;
  fs::create_directories(path_, error);
  if (!fs::is_directory(path_, error)) {
    log.report_file(Code("E0103"), path_.string(), "it is no folder, and cannot be made one");
    return false;
  }
  const fs::path file = lock_of(path_);
  lock_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock_ < 0) {
    log.report_file(Code("E0103"), file.string(), "the file cannot be created");
    return false;
  }
  if (::flock(lock_, LOCK_EX | LOCK_NB) == 0) return true;
  ::close(std::exchange(lock_, -1));
  return refuse("another run writes into this folder", {}, log);
}

// Files and folders that a new run would write over.
bool RunFolder::is_free(const std::set<std::string>& stems, DiagnosticLog& log) const {
  constexpr std::string_view kHint = "choose another folder, or move it away";
  std::error_code ignored;
  std::vector<std::string> found;
  const auto look = [&](const std::string& name) {
    if (fs::exists(path_ / name, ignored)) found.push_back(name);
  };
  for (const std::string& stem : stems)
    for (const std::string& file : files_of(stem)) look(file);
  for (const std::string& file : more_) look(file);
  if (!found.empty())
    return refuse(
        fmt::format("the folder has a file {} of no run{}", in_quotes(found[0]),
                    found.size() == 1 ? "" : fmt::format(", and {} more", found.size() - 1)),
        std::string(kHint), log);
  if (labelling_ == nullptr) return true;
  for (const std::string& format : labelling_->formats)
    if (fs::exists(path_ / format, ignored) && !fs::is_empty(path_ / format, ignored))
      return refuse(fmt::format("the folder has a folder {} of no run, where labels would be",
                                in_quotes(format)),
                    std::string(kHint), log);
  return true;
}

void RunFolder::remove_unfinished(const std::set<std::string>& stems) const {
  std::set<std::string> files = {std::string(kFrames), std::string(kSettingsFile)};
  for (const std::string& stem : stems)
    for (std::string& file : files_of(stem)) files.insert(std::move(file));
  files.insert(more_.begin(), more_.end());
  remove_unfinished_files(path_, files);
}

bool RunFolder::begin(const std::set<std::string>& stems, const std::string& manifest,
                      const std::string& settings, bool resume, DiagnosticLog& log) const {
  const std::pair<std::string_view, const std::string*> kinds[] = {{kSettingsFile, &settings},
                                                                   {kFrames, &manifest}};
  std::error_code ignored;
  const auto is_there = [&](std::string_view name) { return fs::exists(path_ / name, ignored); };
  if (is_there(kFrames) && !resume)
    return refuse("the folder has the frames of a run",
                  "--resume goes on with it; or choose another folder", log);
  for (const auto& [name, expected] : kinds) {
    if (!is_there(name) && !is_there(kFrames)) continue;
    const auto before = read_file(path_ / name, kMostManifestBytes, log);
    if (!before) return false;
    if (*before != *expected)
      return refuse(is_there(kFrames)
                        ? fmt::format("the folder has the frames of another run: {} "
                                      "differs",
                                      name)
                        : fmt::format("the folder has a file {} of another run", in_quotes(name)),
                    "choose another folder", log);
  }
  remove_unfinished(stems);
  if (is_there(kFrames)) return true;
  if (!is_free(stems, log)) return false;
  for (const auto& [name, text] : kinds)
    if (!is_there(name) && !write_file(path_ / name, as_bytes(*text), log)) return false;
  return true;
}

bool RunFolder::has_frame(const std::string& stem, bool previous, bool next) const {
  return std::ranges::all_of(
             outputs_of(stem),
             [&](const std::string& file) { return image::is_whole(path_ / file); }) &&
         (labelling_ == nullptr ||
          labels::has_whole_files(path_ / labels_of(stem), labelling_->flow && next,
                                  labelling_->flow && previous));
}

bool RunFolder::has_part(const std::string& stem) const {
  std::error_code ignored;
  return std::ranges::any_of(
      outputs_of(stem), [&](const std::string& file) { return fs::exists(path_ / file, ignored); });
}

}  // namespace panwright::tools
