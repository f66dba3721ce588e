// Final target of writes to a path. Private to base.
#pragma once

#include <filesystem>

namespace panwright::internal {

struct WriteTarget {
  std::filesystem::path path;  // behind symbolic links; the last of them may lead nowhere yet
  int stream = -1;             // an open descriptor that it names: /dev/stdout, /dev/fd/3
};

// note: no canonical path, which stops at a link that leads nowhere
WriteTarget write_target(const std::filesystem::path& path);

}  // namespace panwright::internal
