// Models from files, whatever their kind.
#pragma once

#include <string>

#include "base/result.h"
#include "pan/model.h"
#include "scene/scene.h"
#include "tools/options.h"
#include "tools/session.h"

namespace panwright::tools {

// Reads a pxn file with the limits of the options.
//
// Fails: E01…, E1…. A scene is returned whenever something could be read; the log says whether
// all of it could.
Result<scene::Scene> read_scene(const std::string& path, const ReadOptions& options,
                                Session& session);

// Opens a pan file and checks it, or compiles a pxn file in memory. The reader is chosen by
// extension.
//
// Fails: E0202, E01…, E1…, E4….
Result<pan::Model> load_model(const std::string& path, const ReadOptions& options,
                              Session& session);

// The file name's extension in lower case, with its point.
std::string extension_of(const std::string& path);

}  // namespace panwright::tools
