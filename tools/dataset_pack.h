// Archives of a data set, as WebDataset reads them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/job.h"
#include "tools/dataset_folder.h"

namespace panwright::tools {

// Writes FOLDER/shard-000000.tar … (POSIX ustar): the files of each frame, in the order of the
// table, all of a frame in one archive; README.md and set.json beside them. The bytes depend on the
// set alone.
//
//   per_shard  frames in an archive, > 0
//   returns    the archives
// Expects: whole frames. Fails: E0001, E0101, E0102, E0103.
Result<std::vector<std::string>> pack_dataset(const DatasetFolder& set, const std::string& folder,
                                              std::uint64_t per_shard, DiagnosticLog& log,
                                              const Job& job);

}  // namespace panwright::tools
