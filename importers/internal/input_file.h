// File being imported. Private to importers.
#pragma once

#include <string>

#include "base/job.h"
#include "base/source.h"

namespace panwright::importers {

struct InputFile {
  std::string path;  // as in Files
  std::string name;  // for messages
  SharedText bytes;  // unpacked
  SourceSpan included_at;
  Job job{};  // of the reading; readers poll it
};

}  // namespace panwright::importers
