#include "base/internal/write_target.h"

#include <string>

namespace panwright::internal {

WriteTarget write_target(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  constexpr int kMostLinks = 40;  // as Linux
  fs::path at = path;
  for (int i = 0; i <= kMostLinks; ++i) {
    // these links stand for what is open, whatever it was opened by
    const std::string folder = at.parent_path().string();
    const std::string name = at.filename().string();
    if ((folder == "/proc/self/fd" || folder == "/dev/fd") && !name.empty() && name.size() < 9 &&
        name.find_first_not_of("0123456789") == std::string::npos)
      return {at, std::stoi(name)};
    std::error_code error;
    if (!fs::is_symlink(at, error)) return {at, -1};
    const fs::path next = fs::read_symlink(at, error);
    if (error) return {at, -1};
    at = at.parent_path() / next;  // an absolute one stands alone
  }
  return {path, -1};
}

}  // namespace panwright::internal
