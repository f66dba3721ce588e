#include "importers/files.h"

#include <unistd.h>

#include <map>
#include <set>
#include <system_error>

#include "base/file.h"
#include "base/file_uses.h"
#include "base/folder_names.h"
#include "base/text.h"

namespace panwright::importers {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMappedFrom = std::uint64_t{1} << 20;  // bytes

// note: behind the last byte of a mapping stand zeros to the end of its page; a file that fills its
// last page has no such NUL, and is read
std::uint64_t page_size() {
  static const auto size = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return size;
}

// Whether a path in normal form leads out of the folder that it is relative to.
bool leads_out(const fs::path& path) {
  return path.empty() || path.is_absolute() || *path.begin() == "..";
}

class FolderFiles : public Files {
 public:
  FolderFiles(const fs::path& folder, std::uint64_t max_bytes, const DiagnosticLog& log,
              const std::string& model)
      : typed_(folder), model_(model), left_(max_bytes), log_(log.apart()) {
    std::error_code error;
    real_ =
        fs::weakly_canonical(fs::absolute(folder.empty() ? fs::path(".") : folder, error), error);
  }

  Outcome read(const std::string& path, SharedText& bytes) override {
    if (leads_out(path)) return Outcome::outside;
    std::error_code error;
    const fs::path real = fs::canonical(real_ / path, error);
    if (error) return Outcome::missing;
    if (path != model_ && leads_out(real.lexically_relative(real_))) return Outcome::outside;
    if (!fs::is_regular_file(real, error)) return Outcome::missing;
    const std::uint64_t size = fs::file_size(real, error);
    if (error) return Outcome::unreadable;
    if (size > left_) return Outcome::too_large;
    if (size > kMappedFrom && size % page_size() != 0) {
      DiagnosticLog ignored = log_.apart();
      if (auto mapped = MappedFile::open(real, ignored)) {
        const auto mapping = std::make_shared<const MappedFile>(std::move(*mapped));
        const std::span<const std::byte> whole = mapping->bytes();
        if (whole.size() == size) {
          left_ -= size;
          bytes = SharedText(mapping, {reinterpret_cast<const char*>(whole.data()), whole.size()});
          return Outcome::found;
        }
      }
    }
    DiagnosticLog log = log_.apart();  // the caller says it in its own words
    auto text = read_file(real, left_, log);
    if (!text) return log.contains(Code("E0104")) ? Outcome::too_large : Outcome::unreadable;
    left_ -= text->size();
    bytes = std::make_shared<const std::string>(std::move(*text));
    return Outcome::found;
  }

  std::optional<std::string> same_but_for_case(const std::string& path) override {
    if (leads_out(path)) return std::nullopt;
    const auto found = names_.same_but_for_case(real_, path);
    return found ? std::optional(found->generic_string()) : std::nullopt;
  }

  std::optional<std::string> relative(const std::string& path) const override {
    return fs::path(path).lexically_normal().lexically_relative(real_).generic_string();
  }

  void declare(const std::string& path) override {
    constexpr std::size_t kMost = 10'000;
    if (log_.files() && declared_.size() < kMost && declared_.insert(path).second)
      log_.files()->will_read(real_ / path);
  }

  std::string display_name(const std::string& path) const override {
    return (typed_ / path).lexically_normal().string();
  }

 private:
  fs::path typed_;
  std::string model_;
  fs::path real_;
  std::uint64_t left_;
  const DiagnosticLog log_;  // an empty one of the run
  std::set<std::string> declared_;
  FolderNames names_;
};

class MemoryFiles : public Files {
 public:
  MemoryFiles(std::span<const MemoryFile> files, std::uint64_t max_bytes) : left_(max_bytes) {
    for (const MemoryFile& file : files)
      files_.emplace(fs::path(file.path).lexically_normal().generic_string(), &file.bytes);
  }

  Outcome read(const std::string& path, SharedText& bytes) override {
    const auto found = files_.find(path);
    if (found == files_.end()) return leads_out(path) ? Outcome::outside : Outcome::missing;
    if (found->second->size() > left_) return Outcome::too_large;
    left_ -= found->second->size();
    // shares nothing and owns nothing: the caller keeps the bytes
    bytes = std::shared_ptr<const std::string>(std::shared_ptr<void>(), found->second);
    return Outcome::found;
  }

  std::optional<std::string> same_but_for_case(const std::string& path) override {
    std::optional<std::string> found;
    for (const auto& [name, bytes] : files_) {
      if (lower_case(name) != lower_case(path)) continue;
      if (found) return std::nullopt;
      found = name;
    }
    return found;
  }

  std::string display_name(const std::string& path) const override { return path; }

 private:
  std::map<std::string, const std::string*> files_;
  std::uint64_t left_;
};

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 &&
        hex_digit(text[i + 2]) >= 0) {
      out += static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2]));
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

// "http", "urn", "C"…: what stands before a colon that no '/' precedes.
bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  return colon != uri.npos && uri.find('/') > colon;
}

}  // namespace

std::unique_ptr<Files> files_in_folder(const fs::path& folder, std::uint64_t max_bytes,
                                       const DiagnosticLog& log, const std::string& model) {
  return std::make_unique<FolderFiles>(folder, max_bytes, log, model);
}

std::unique_ptr<Files> files_in_memory(std::span<const MemoryFile> files, std::uint64_t max_bytes) {
  return std::make_unique<MemoryFiles>(files, max_bytes);
}

std::string path_in(std::string_view uri, bool percent_encoded) {
  std::string path = percent_encoded ? percent_decoded(uri) : std::string(uri);
  for (char& c : path)
    if (c == '\\') c = '/';
  if (path.starts_with("file:")) path.erase(0, path.starts_with("file://") ? 7 : 5);
  return path;
}

bool is_absolute(std::string_view path) {
  if (path.starts_with('/')) return true;
  return path.size() > 1 && path[1] == ':' &&
         ((path[0] >= 'a' && path[0] <= 'z') || (path[0] >= 'A' && path[0] <= 'Z'));
}

void declare(Files& files, std::string_view including, std::string_view uri, bool percent_encoded) {
  constexpr std::size_t kLongest = 1024;  // what is longer is a script, or data
  if (uri.size() > kLongest) return;
  const std::string path = path_in(uri.substr(0, uri.find('#')), percent_encoded);
  if (path.empty() || path.find_first_of(std::string_view("\0\n", 2)) != path.npos ||
      has_scheme(path))
    return;
  files.declare((fs::path(including).parent_path() / path).lexically_normal().generic_string());
}

std::optional<std::string> resolved(std::string_view including, std::string_view uri,
                                    bool percent_encoded) {
  const std::string path = path_in(uri, percent_encoded);
  if (path.empty() || path.find('\0') != path.npos || path.front() == '/' || has_scheme(path))
    return std::nullopt;
  return (fs::path(including).parent_path() / path).lexically_normal().generic_string();
}

}  // namespace panwright::importers
