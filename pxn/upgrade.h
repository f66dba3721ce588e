// Level 0 → level 1, text to text.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "pxn/pxn.h"

namespace panwright::pxn {

struct UpgradedFile {
  std::string path;       // as given
  std::string text;       // in canonical form; empty: it is of level 1 already
  std::size_t paths = 0;  // of includes and textures that had to change
};

// Writes files of level 0 in the words of level 1, with their comments: transform and rotate with
// attributes and without <child> and a <group> that holds all the rest, frame_s as frame, paths
// relative to the file that names them. Appearances stay: what they leave out may come from around
// the file. Files that are included are upgraded only if they are named too.
//
//   paths    of files; those that an earlier one includes, directly or not, are upgraded as parts
//   of
//            that model
//   returns  the texts, in the same order; models were read before and after, and look the same bit
//            for bit (Likeness::looks)
//
// Fails: what pxn::read reports; E1317 when the text would not mean the same.
// Reports: N1318. Cost: that of reading the models twice.
[[nodiscard]] Result<std::vector<UpgradedFile>> upgraded(std::span<const std::string> paths,
                                                         const Options& options, DiagnosticLog& log,
                                                         const Job& job = {});

}  // namespace panwright::pxn
