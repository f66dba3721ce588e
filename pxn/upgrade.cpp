#include "pxn/upgrade.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "base/file.h"
#include "base/text.h"
#include "pxn/format.h"
#include "pxn/reader/files.h"
#include "pxn/reader/read_from.h"
#include "pxn/reader/upgrade_text.h"
#include "pxn/text/grammar.h"
#include "pxn/text/xml.h"
#include "pxn/writer.h"

namespace panwright::pxn {

namespace {

namespace fs = std::filesystem;

// By the key of a file: its new text.
using Texts = std::map<std::string, std::shared_ptr<const std::string>>;

// Files of the disk, some of them with other texts.
class ChangedFiles : public Files {
 public:
  ChangedFiles(std::unique_ptr<Files> disk, const Texts& texts)
      : disk_(std::move(disk)), texts_(texts) {}

  Outcome find(std::string_view file, const FoundFile& including, bool own_folder,
               FoundFile& out) const override {
    return disk_->find(file, including, own_folder, out);
  }
  std::optional<std::string> same_but_for_case(const std::string& file,
                                               const FoundFile& including) override {
    return disk_->same_but_for_case(file, including);
  }
  std::string near_name(std::string_view file, const FoundFile& including,
                        bool own_folder) const override {
    return disk_->near_name(file, including, own_folder);
  }
  Result<std::shared_ptr<const std::string>> load(const FoundFile& file, SourceSpan where,
                                                  DiagnosticLog& log) override {
    const auto changed = texts_.find(file.key);
    return changed == texts_.end() ? disk_->load(file, where, log) : changed->second;
  }

 private:
  std::unique_ptr<Files> disk_;
  const Texts& texts_;
};

class Upgrader {
 public:
  Upgrader(std::span<const std::string> paths, const Options& options, DiagnosticLog& log,
           const Job& job)
      : paths_(paths),
        options_(options),
        log_(log),
        job_(job),
        out_(paths.size()),
        done_(paths.size()) {}

  Result<std::vector<UpgradedFile>> run() {
    for (std::size_t i = 0; i < paths_.size(); ++i)
      if (!done_[i] && !model(i)) return failed;
    return std::move(out_);
  }

 private:
  // One model, and those of its files that are named.
  bool model(std::size_t first) {
    FoundFile top;
    const auto files = files_on_disk(paths_[first], options_, top);
    const std::size_t errors = log_.errors();
    const auto before = read_from(*files, top, options_, log_, job_);
    if (!before || log_.errors() > errors) return false;

    const fs::path folder = fs::path(top.key).parent_path();
    std::set<std::string> inputs;
    for (const scene::Input& input : before->inputs)
      inputs.insert((folder / input.path).lexically_normal().string());
    Texts texts;
    for (std::size_t i = first; i < paths_.size(); ++i) {
      if (done_[i]) continue;
      std::error_code error;
      const std::string key = fs::weakly_canonical(fs::absolute(paths_[i], error), error).string();
      if (key != top.key && !inputs.contains(key)) continue;
      done_[i] = true;
      if (!upgrade(i, key, *files, texts)) return false;
    }
    return texts.empty() || same(first, top, *before, texts);
  }

  bool upgrade(std::size_t index, const std::string& key, const Files& files, Texts& texts) {
    UpgradedFile& out = out_[index];
    out.path = paths_[index];
    auto bytes = read_file(key, options_.limits.bytes, log_);
    if (!bytes) return false;
    const FileId id = log_.sources().add(
        {out.path, std::make_shared<const std::string>(std::move(*bytes)), Encoding::utf8, {}});
    xml::Document document = xml::scan(id, {options_.limits.elements, options_.limits.depth}, log_);
    Reporter reporter(log_);
    if (!check_grammar(document, schemas::kPxn, reporter)) return false;
    const xml::Attribute* version = find_attribute(document, 0, "ver");
    if (version == nullptr ||
        xml::decoded(document, version->value_begin, version->value_end) != "0")
      return true;

    const fs::path own_folder = fs::path(key).parent_path();
    const FoundFile including{key, out.path, {}};
    const auto new_path = [&](const std::string& file) -> std::optional<std::string> {
      FoundFile found;
      if (files.find(file, including, false, found) != Files::Outcome::found) return std::nullopt;
      // what the path already means from its own folder stays as it is written
      FoundFile again;
      if (files.find(file, including, true, again) == Files::Outcome::found &&
          again.key == found.key)
        return file;
      return fs::path(found.key).lexically_relative(own_folder).generic_string();
    };
    const auto changed = [&](SourceSpan where, const std::string& from, const std::string& to) {
      ++out.paths;
      log_.report(Code("N1318"), where,
                  fmt::format("{} becomes {}: paths of level 1 begin at the file that names them",
                              in_quotes(from), in_quotes(to)));
    };
    const std::string raw = upgraded_text(document, new_path, changed);
    auto text =
        formatted(out.path, std::make_shared<const std::string>(raw), options_.limits, log_);
    if (!text) return false;
    out.text = std::move(*text);
    texts[key] = std::make_shared<const std::string>(out.text);
    return true;
  }

  // Reads the model with the new texts and compares.
  bool same(std::size_t first, const FoundFile& top, const scene::Scene& before,
            const Texts& texts) {
    FoundFile again;
    ChangedFiles files(files_on_disk(paths_[first], options_, again), texts);
    DiagnosticLog log;
    const auto after = read_from(files, again, options_, log, job_);
    job_.poll();
    std::string difference;
    if (!after || log.has_errors()) {
      const auto& entries = log.entries();
      const auto error = std::find_if(entries.begin(), entries.end(), [](const Diagnostic& d) {
        return d.severity() == Severity::error;
      });
      difference = error == entries.end() ? "it cannot be read" : error->message;
    } else {
      difference = scene_difference(before, *after, Likeness::looks);
    }
    if (difference.empty()) return true;
    log_.report_file(Code("E1317"), top.name,
                     fmt::format("in the words of level 1 the model would change: {}", difference));
    return false;
  }

  std::span<const std::string> paths_;
  const Options& options_;
  DiagnosticLog& log_;
  const Job& job_;
  std::vector<UpgradedFile> out_;
  std::vector<bool> done_;
};

}  // namespace

Result<std::vector<UpgradedFile>> upgraded(std::span<const std::string> paths,
                                           const Options& options, DiagnosticLog& log,
                                           const Job& job) {
  return run_job(job, log, [&] { return Upgrader(paths, options, log, job).run(); });
}

}  // namespace panwright::pxn
