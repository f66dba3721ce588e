#include "base/folder_names.h"

#include <system_error>

namespace panwright {

namespace fs = std::filesystem;

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

const FolderNames::Names& FolderNames::names_in(const fs::path& folder) {
  constexpr std::size_t kMostNames = 100'000;
  const auto [place, is_new] = folders_.try_emplace(folder);
  Names& names = place->second;
  if (!is_new) return names;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    std::string name = entry->path().filename().string();
    std::string key = lower_case(name);
    const auto [known, first] = names.try_emplace(std::move(key), std::move(name));
    if (!first) known->second.clear();
    if (names.size() <= kMostNames) continue;
    names.clear();
    break;
  }
  return names;
}

std::optional<fs::path> FolderNames::same_but_for_case(const fs::path& folder,
                                                       const fs::path& path) {
  fs::path found;
  for (const fs::path& part : path) {
    std::error_code error;
    if (fs::exists(folder / found / part, error)) {
      found /= part;
      continue;
    }
    const Names& names = names_in((folder / found).lexically_normal());
    const auto name = names.find(lower_case(part.string()));
    if (name == names.end() || name->second.empty()) return std::nullopt;
    found /= name->second;
  }
  return found;
}

}  // namespace panwright
