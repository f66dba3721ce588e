// Names of files in folders, whatever their letter case.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace panwright {

// Returns a text with ASCII letters in lower case.
std::string lower_case(std::string_view text);

// Lists of folders, each read once.
class FolderNames {
 public:
  // Returns the one existing path below `folder` that differs from `path` in the case of ASCII
  // letters at most. Nothing: there is none, there are several, or a folder has more than 100,000
  // names.
  std::optional<std::filesystem::path> same_but_for_case(const std::filesystem::path& folder,
                                                         const std::filesystem::path& path);

 private:
  using Names = std::unordered_map<std::string, std::string>;  // by lower case; empty: several
  const Names& names_in(const std::filesystem::path& folder);

  std::map<std::filesystem::path, Names> folders_;
};

}  // namespace panwright
