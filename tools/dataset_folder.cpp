#include "tools/dataset_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "base/file.h"
#include "base/hash.h"
#include "base/text.h"
#include "labels/frame_files.h"

namespace panwright::tools {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMostTableBytes = 8ull << 30;
constexpr std::uint64_t kMostFrameBytes = 1 << 24;

// The hash of a file; empty: it cannot be read.
std::string hash_of(const fs::path& file) {
  DiagnosticLog unheard;
  const auto mapped = MappedFile::open(file, unheard);
  return mapped ? hash128(mapped->bytes()).hex() : std::string();
}

bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= 100 && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

Json pairs(const std::vector<std::pair<std::string, std::string>>& list) {
  Json out = Json::object();
  for (const auto& [name, text] : list) out[name] = text;
  return out;
}

std::vector<std::pair<std::string, std::string>> pairs_of(const Json& object) {
  std::vector<std::pair<std::string, std::string>> out;
  for (const auto& [name, text] : object.items()) out.emplace_back(name, text.get<std::string>());
  return out;
}

}  // namespace

std::string dataset_settings_text(const DatasetSettings& of) {
  const Json out{{"schema", 1},
                 {"program", of.program},
                 {"plan", of.plan},
                 {"folder", of.folder},
                 {"seed", of.seed},
                 {"targets", pairs(of.targets)},
                 {"build_ids", pairs(of.build_ids)},
                 {"view", Json::parse(of.view)},
                 {"camera", of.camera},
                 {"types", of.types},
                 {"labels", Json::parse(of.labels_json)}};
  return out.dump(2, ' ', true, Json::error_handler_t::replace) + "\n";
}

Result<DatasetFolder> DatasetFolder::open(const fs::path& path, DiagnosticLog& log) {
  DatasetFolder out;
  out.path_ = path;
  std::error_code ignored;
  if (!fs::exists(path / "set.json", ignored)) {
    log.report_file(Code("E8018"), path.string(),
                    "the folder has no set.json, so it is no data set",
                    "panwright dataset plan PLAN.toml -o FOLDER makes one");
    return failed;
  }
  if (!out.read_settings(log) || !out.read_rows(log)) return failed;
  out.files_ = std::make_shared<const RunFolder>(out.frames_path(), out.settings_.types,
                                                 out.settings_.labels);
  return out;
}

bool DatasetFolder::read_settings(DiagnosticLog& log) {
  const fs::path file = path_ / "set.json";
  auto text = read_file(file, kMostFrameBytes, log);
  if (!text) return false;
  settings_text_ = *std::move(text);
  try {
    const Json json = Json::parse(settings_text_);
    DatasetSettings& out = settings_;
    out.program = json.at("program");
    out.plan = json.at("plan");
    out.folder = json.at("folder");
    out.seed = json.at("seed");
    out.targets = pairs_of(json.at("targets"));
    out.build_ids = pairs_of(json.at("build_ids"));
    out.view = json.at("view").dump();
    out.camera = json.at("camera");
    out.types = json.at("types");
    const Json& labels = json.at("labels");
    out.labels_json = labels.dump();
    if (!labels.is_null()) {
      workspace::Labelling labelling;
      labelling.options.keypoint_slack =
          labels.value("keypoint_slack", labelling.options.keypoint_slack);
      if (labels.contains("parts"))
        for (const auto& [label, node] : labels["parts"].items())
          for (const Json& each : node.is_array() ? node : Json::array({node}))
            labelling.options.parts.push_back({label, each.get<std::string>()});
      out.labels = std::make_shared<const workspace::Labelling>(std::move(labelling));
    }
    if (!out.types.empty()) return true;
  } catch (const nlohmann::json::exception&) {
  }
  log.report_file(Code("E8018"), file.string(), "it is not as `dataset plan` wrote it",
                  "plan the set again, into another folder");
  return false;
}

bool DatasetFolder::read_rows(DiagnosticLog& log) {
  const fs::path file = path_ / "frames.jsonl";
  const auto text = read_file(file, kMostTableBytes, log);
  if (!text) return false;
  std::set<std::string> known;
  const std::size_t errors = log.errors();
  for (std::size_t at = 0; at < text->size();) {
    const std::size_t end = std::min(text->find('\n', at), text->size());
    std::string row = text->substr(at, end - at);
    at = end + 1;
    if (row.empty()) continue;
    const auto json = nlohmann::json::parse(row, nullptr, false);
    const bool named = json.is_object() && json.contains("name") && json["name"].is_string();
    const auto name = named ? json["name"].get<std::string>() : std::string();
    if (!is_name(name))
      log.report_file(Code("E8018"), file.string(),
                      fmt::format("row {} has no name of letters, digits, _ and -", rows_.size()),
                      "one JSON object a line, as {\"name\": \"000000\", …}");
    else if (!known.insert(name).second)
      log.report_file(Code("E8018"), file.string(),
                      fmt::format("two rows have the name {}", in_quotes(name)));
    rows_.push_back(std::move(row));
    names_.push_back(name);
  }
  if (rows_.empty()) log.report_file(Code("E8018"), file.string(), "the table has no rows");
  return log.errors() == errors;
}

std::vector<std::string> DatasetFolder::files_of(std::size_t k) const {
  std::vector<std::string> out = images_of(k);
  if (settings_.labels == nullptr) return out;
  for (const std::string_view extension : {labels::kLabelsExtension, labels::kMasksExtension})
    out.push_back(names_[k] + std::string(extension));
  return out;
}

std::string DatasetFolder::row_hash(std::size_t k) const {
  Hasher hasher;
  hasher.update(as_bytes(settings_text_));
  hasher.update(as_bytes(std::to_string(k)));  // which the noise follows
  hasher.update(as_bytes(rows_[k]));
  return hasher.digest128().hex();
}

FrameState DatasetFolder::state_of(std::size_t k) const {
  const fs::path file = frames_path() / (names_[k] + std::string(kFrameExtension));
  std::error_code error;
  if (!fs::exists(file, error)) return FrameState::missing;
  DiagnosticLog unheard;
  const auto text = read_file(file, kMostFrameBytes, unheard);
  const auto json = nlohmann::json::parse(text ? *text : "", nullptr, false);
  if (!json.is_object() || !json.contains("files") || !json["files"].is_object())
    return FrameState::damaged;
  if (json.value("made_from", nlohmann::json()) != row_hash(k)) return FrameState::changed;
  for (const std::string& each : files_of(k)) {
    const auto expected = json["files"].find(each);
    if (expected == json["files"].end() || *expected != hash_of(frames_path() / each))
      return FrameState::damaged;
  }
  return FrameState::whole;
}

bool DatasetFolder::finish(std::size_t k, DiagnosticLog& log) const {
  Json out{{"number", k}, {"made_from", row_hash(k)}};
  for (const std::string& each : files_of(k)) {
    const auto mapped = MappedFile::open(frames_path() / each, log);
    if (!mapped) return false;
    out["files"][each] = hash128(mapped->bytes()).hex();
  }
  out["view"] = Json::parse(rows_[k]);
  return write_file(frames_path() / (names_[k] + std::string(kFrameExtension)),
                    as_bytes(out.dump() + "\n"), log);
}

std::vector<std::string> DatasetFolder::strangers() const {
  std::set<std::string> known;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    for (std::string& each : files_of(k)) known.insert(std::move(each));
    known.insert(names_[k] + std::string(kFrameExtension));
  }
  std::vector<std::string> out;
  std::error_code error;
  for (fs::directory_iterator at(frames_path(), error), end; !error && at != end;
       at.increment(error))
    if (std::string name = at->path().filename().string(); !known.contains(name))
      out.push_back(std::move(name));
  std::ranges::sort(out);
  return out;
}

void DatasetFolder::remove_unfinished(std::size_t first, std::size_t end) const {
  std::set<std::string> files;
  for (std::size_t k = first; k < end; ++k) {
    for (std::string& each : files_of(k)) files.insert(std::move(each));
    files.insert(names_[k] + std::string(kFrameExtension));
  }
  remove_unfinished_files(frames_path(), files);
}

bool DatasetFolder::take(std::size_t first, std::size_t end, DiagnosticLog& log) const {
  const fs::path file = path_ / "set.json";
  // a byte for each frame; kept until the process ends, whatever becomes of it
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(first);
  lock.l_len = static_cast<off_t>(end - first);
  if (descriptor >= 0 && ::fcntl(descriptor, F_OFD_SETLK, &lock) == 0) return true;
  const bool busy = descriptor >= 0 && (errno == EAGAIN || errno == EACCES);
  if (descriptor >= 0) ::close(descriptor);
  log.report_file(
      busy ? Code("E8018") : Code("E0103"), path_.string(),
      busy ? fmt::format("another process renders some of the frames {} to {}", first, end - 1)
           : "its frames cannot be locked",
      busy ? "give each process a shard of its own, of the same number of shards" : "");
  return false;
}

}  // namespace panwright::tools
