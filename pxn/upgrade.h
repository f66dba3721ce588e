// Upgrade of texts from level 0 to level 1.
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
  std::string text;       // in canonical form; empty: already of level 1
  std::size_t paths = 0;  // changed ones, of includes and textures
};

// Upgrades files of level 0 to level 1, with their comments: transform and rotate with attributes
// and without <child> and a <group> around all the rest, frame_s as frame, paths relative to their
// file. Appearances stay: missing fields may come from around the file. Included files are upgraded
// only if listed too.
//
//   paths    of files; those included by an earlier one, directly or not, are upgraded as
//            parts of that model
//   returns  the texts, in the same order; models were read before and after, and are equal bit for
//            bit (Likeness::looks)
//
// Fails: as pxn::read; E1317 if the meaning would change.
// Reports: N1318. Cost: that of reading the models twice.
[[nodiscard]] Result<std::vector<UpgradedFile>> upgraded(std::span<const std::string> paths,
                                                         const Options& options, DiagnosticLog& log,
                                                         const Job& job = {});

}  // namespace panwright::pxn
