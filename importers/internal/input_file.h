// A file that is being imported. Private to importers.
#pragma once

#include <string>

#include "base/job.h"
#include "base/source.h"

namespace panwright::importers {

struct InputFile {
  std::string path;  // as Files knows it
  std::string name;  // as the user would type it
  SharedText bytes;  // unpacked
  SourceSpan included_at;
  Job job{};  // of the reading; readers poll it
};

}  // namespace panwright::importers
