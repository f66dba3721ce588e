// Models from files, whatever their kind.
#pragma once

#include <string>

#include "base/result.h"
#include "compiler/hidden.h"
#include "importers/hygiene.h"
#include "importers/import.h"
#include "pan/model.h"
#include "scene/scene.h"
#include "tools/options.h"
#include "tools/session.h"

namespace panwright::tools {

// Reads a pxn or CAD file with the limits of the options.
//
// Fails: E01…, E1…. A scene is returned whenever something could be read; the log says whether
// all of it could.
Result<scene::Scene> read_scene(const std::string& path, const ReadOptions& options,
                                Session& session);

// Whether a file is one for the importers, by its extension.
bool is_cad(const std::string& path);

// Reads a CAD file, cleans it and puts it in its place, as the options say.
//
//   hygiene  when given, what cleaning found
Result<importers::Imported> read_cad(const std::string& path, const ReadOptions& options,
                                     Session& session, importers::Hygiene* hygiene = nullptr);

// Takes away what nobody outside can see, of those instances that may lose it.
//
//   returns  whether there was any such instance
bool prune(scene::Scene& scene, const ReadOptions& options, Session& session,
           compiler::HiddenReport* report = nullptr);

// Opens a pan file and checks it, or compiles a pxn or CAD file in memory. The reader is chosen by
// extension.
//
// Fails: E0202, E01…, E1…, E4….
Result<pan::Model> load_model(const std::string& path, const ReadOptions& options,
                              Session& session);

// The file name's extension in lower case, with its point.
std::string extension_of(const std::string& path);

}  // namespace panwright::tools
