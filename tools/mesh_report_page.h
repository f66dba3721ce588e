// HTML page of the mesh report.
#pragma once

#include <string>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "importers/mesh_report.h"
#include "scene/scene.h"
#include "workspace/open.h"

namespace panwright::tools {

// Returns one HTML page: the figures of the whole and of each mesh, and images of the worst spots,
// each in a ring. Without OpenGL, or for a scene that does not compile, without images.
//
// Fails: E0001.
Result<std::string> mesh_report_page(const importers::MeshReport& mesh_report,
                                     const scene::Scene& scene, const std::string& input,
                                     const workspace::OpenOptions& options, DiagnosticLog& log,
                                     const Job& job);

}  // namespace panwright::tools
