// A file that is being imported. Private to importers.
#pragma once

#include <memory>
#include <string>

#include "base/source.h"

namespace panwright::importers {

struct InputFile {
  std::string path;                          // as Files knows it
  std::string name;                          // as the user would type it
  std::shared_ptr<const std::string> bytes;  // unpacked
  SourceSpan included_at;
};

}  // namespace panwright::importers
