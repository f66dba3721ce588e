// Checks of what a pan file refuses, at the elements that it comes from. Private to compiler.
#pragma once

#include <string>

#include "base/diagnostic.h"
#include "pan/writer.h"
#include "scene/scene.h"

namespace panwright::compiler::internal {

// Returns "wing.pxn:3:5", or the file where the line is unknown.
std::string place_of(const scene::Source& source);

// Reports a problem of an element: at its name where the log has the text, else with place_of()
// before the message.
void report_at(const scene::Source& source, Code code, const std::string& message, std::string hint,
               DiagnosticLog& log);

// Checks the numbers of a mesh. Reports: E2010, E2011, without a place.
bool is_sound(const pan::PackedMesh& mesh, DiagnosticLog& log);

// Checks that nodes with joints at their initial values, and keypoints, have places that double
// precision holds. Reports: E2010, for the first.
bool is_sound(const scene::Scene& scene, DiagnosticLog& log);

}  // namespace panwright::compiler::internal
