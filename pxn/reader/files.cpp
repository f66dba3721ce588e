#include "pxn/reader/files.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <system_error>
#include <vector>

#include "base/file.h"
#include "base/folder_names.h"
#include "base/text.h"

namespace panwright::pxn {

namespace {

namespace fs = std::filesystem;

// how many names of a folder are compared with one that is missing
constexpr std::size_t kMostFolderNames = 2000;

// source spans are 32 bits wide
constexpr std::uint64_t kMostBytes = 0xfffffffe;

// Whether a path lies in a folder, both in normal form.
bool is_inside(const fs::path& path, const fs::path& folder) {
  const auto [end_of_folder, rest] =
      std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end_of_folder == folder.end();
}

// Without the empty last part that a final '/' leaves.
fs::path folder_form(const fs::path& path) {
  const fs::path normal = path.lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

std::string too_large(const FoundFile& file, std::uint64_t limit) {
  return fmt::format("{} brings the input to more than {} bytes", in_quotes(file.name), limit);
}

class DiskFiles : public Files {
 public:
  DiskFiles(const fs::path& top, const Options& options, FoundFile& found)
      : limit_(std::min(options.limits.bytes, kMostBytes)), unsaved_(options.unsaved) {
    std::error_code error;
    const fs::path absolute = fs::absolute(top, error);
    top_typed_ = top.parent_path();
    top_folder_ = folder_form(fs::weakly_canonical(absolute.parent_path(), error));
    const fs::path root = options.root.empty() ? top_folder_ : fs::absolute(options.root, error);
    root_ = folder_form(fs::weakly_canonical(root, error));
    found.key = fs::weakly_canonical(absolute, error).string();
    found.name = top.string();
    found.path = top.filename().string();
  }

  Outcome find(std::string_view file, const FoundFile& including, bool own_folder,
               FoundFile& out) const override {
    const fs::path wanted(file);
    // note: an absolute path replaces the folder it is appended to
    const fs::path candidates[] = {top_folder_ / wanted,
                                   fs::path(including.key).parent_path() / wanted};
    const fs::path typed[] = {top_typed_ / wanted, fs::path(including.name).parent_path() / wanted};
    bool outside = true;
    for (std::size_t i = own_folder ? 1 : 0; i < 2; ++i) {
      if (!is_inside(candidates[i].lexically_normal(), root_)) continue;
      outside = false;
      std::error_code error;
      const fs::path real = fs::canonical(candidates[i], error);
      if (error) continue;
      // symbolic links may lead elsewhere than the path says
      if (!is_inside(real, root_)) return Outcome::outside;
      if (!fs::is_regular_file(real, error)) continue;
      out.key = real.string();
      out.name = typed[i].lexically_normal().string();
      out.path = real.lexically_relative(top_folder_).generic_string();
      return Outcome::found;
    }
    return outside ? Outcome::outside : Outcome::missing;
  }

  std::optional<std::string> same_but_for_case(const std::string& file,
                                               const FoundFile& including) override {
    const fs::path folder = fs::path(including.key).parent_path();
    const fs::path wanted = (folder / file).lexically_normal();
    if (!is_inside(wanted, root_)) return std::nullopt;
    const auto found = names_.same_but_for_case(root_, wanted.lexically_relative(root_));
    if (!found) return std::nullopt;
    return (root_ / *found).lexically_relative(folder).generic_string();
  }

  std::string near_name(std::string_view file, const FoundFile& including,
                        bool own_folder) const override {
    const fs::path first = own_folder ? fs::path(including.key).parent_path() : top_folder_;
    const fs::path wanted = first / fs::path(file);
    const fs::path folder = wanted.parent_path();
    std::error_code error;
    const fs::path real = fs::canonical(folder, error);
    if (error || !is_inside(real, root_)) return {};
    std::vector<std::string> names;
    for (fs::directory_iterator entry(real, error), end; !error && entry != end;
         entry.increment(error)) {
      if (names.size() >= kMostFolderNames) return {};
      names.push_back(entry->path().filename().string());
    }
    // folders have no order of their own
    std::sort(names.begin(), names.end());
    const std::vector<std::string_view> views(names.begin(), names.end());
    const auto near = nearest_name(wanted.filename().string(), views);
    return near ? (fs::path(file).parent_path() / *near).generic_string() : "";
  }

  Result<std::shared_ptr<const std::string>> load(const FoundFile& file, SourceSpan where,
                                                  DiagnosticLog& log) override {
    if (unsaved_ != nullptr)
      if (const auto text = unsaved_->find(file.key); text != unsaved_->end()) {
        used_ += text->second->size();
        if (used_ <= limit_) return text->second;
        log.report(Code("E0104"), where, too_large(file, limit_));
        return failed;
      }
    std::error_code error;
    const std::uint64_t size = fs::file_size(file.key, error);
    if (!error && used_ > 0 && size > limit_ - used_) {
      log.report(Code("E0104"), where, too_large(file, limit_));
      return failed;
    }
    auto bytes = read_file(where.file == kNoFile ? fs::path(file.name) : fs::path(file.key),
                           limit_ - used_, log, where);
    if (!bytes) return failed;
    used_ += bytes->size();
    return std::shared_ptr<const std::string>(
        std::make_shared<const std::string>(std::move(*bytes)));
  }

 private:
  fs::path top_typed_;
  fs::path top_folder_;
  fs::path root_;
  std::uint64_t limit_;
  std::uint64_t used_ = 0;
  decltype(Options::unsaved) unsaved_;
  FolderNames names_;
};

class MemoryFiles : public Files {
 public:
  MemoryFiles(std::span<const MemoryFile> files, const Options& options, FoundFile& found)
      : limit_(std::min(options.limits.bytes, kMostBytes)) {
    for (const MemoryFile& file : files) files_.emplace(normal(file.path), &file.bytes);
    found.key = normal(files[0].path);
    found.name = files[0].path;
    found.path = fs::path(found.key).filename().generic_string();
    top_folder_ = fs::path(found.key).parent_path();
  }

  Outcome find(std::string_view file, const FoundFile& including, bool own_folder,
               FoundFile& out) const override {
    bool outside = true;
    const fs::path own = fs::path(including.key).parent_path();
    for (const fs::path& folder : {own_folder ? own : top_folder_, own}) {
      const std::string key = (folder / fs::path(file)).lexically_normal().generic_string();
      const std::string path = fs::path(key).lexically_relative(top_folder_).generic_string();
      if (!fs::path(key).is_relative() || key.starts_with("..") || path.starts_with("..")) continue;
      outside = false;
      if (!files_.contains(key)) continue;
      out = {key, key, top_folder_.empty() ? key : path};
      return Outcome::found;
    }
    return outside ? Outcome::outside : Outcome::missing;
  }

  std::optional<std::string> same_but_for_case(const std::string& file,
                                               const FoundFile& including) override {
    const fs::path folder = fs::path(including.key).parent_path();
    const std::string wanted = lower_case(normal((folder / file).generic_string()));
    std::optional<std::string> found;
    for (const auto& [key, bytes] : files_) {
      if (lower_case(key) != wanted) continue;
      if (found) return std::nullopt;
      found = fs::path(key).lexically_relative(folder.empty() ? "." : folder).generic_string();
    }
    return found;
  }

  std::string near_name(std::string_view file, const FoundFile& including,
                        bool own_folder) const override {
    const fs::path first = own_folder ? fs::path(including.key).parent_path() : top_folder_;
    std::vector<std::string_view> names;
    for (const auto& [key, bytes] : files_) names.push_back(key);
    const auto near = nearest_name((first / fs::path(file)).generic_string(), names);
    return near ? std::string(*near) : "";
  }

  Result<std::shared_ptr<const std::string>> load(const FoundFile& file, SourceSpan where,
                                                  DiagnosticLog& log) override {
    const std::string& bytes = *files_.at(file.key);
    if (bytes.size() > limit_ - used_) {
      if (where.file == kNoFile)
        log.report_file(Code("E0104"), file.name, too_large(file, limit_));
      else
        log.report(Code("E0104"), where, too_large(file, limit_));
      return failed;
    }
    used_ += bytes.size();
    return std::shared_ptr<const std::string>(std::make_shared<const std::string>(bytes));
  }

 private:
  static std::string normal(const std::string& path) {
    return fs::path(path).lexically_normal().generic_string();
  }

  std::map<std::string, const std::string*> files_;
  fs::path top_folder_;
  std::uint64_t limit_;
  std::uint64_t used_ = 0;
};

}  // namespace

std::unique_ptr<Files> files_on_disk(const std::filesystem::path& top, const Options& options,
                                     FoundFile& found_top) {
  return std::make_unique<DiskFiles>(top, options, found_top);
}

std::unique_ptr<Files> files_in_memory(std::span<const MemoryFile> files, const Options& options,
                                       FoundFile& found_top) {
  return std::make_unique<MemoryFiles>(files, options, found_top);
}

}  // namespace panwright::pxn
