// Maps of planets from files. Private to workspace.
#pragma once

#include <memory>
#include <string>

#include "base/diagnostic.h"
#include "light/body.h"

namespace panwright::workspace {

// Files of maps of a planet; empty: none.
struct PlanetFiles {
  std::string map, clouds, night;
};

// Returns the albedo of ground and clouds relative to its mean, `albedo`; null after a problem.
//
// Fails: E0101, E0102, E3001, E3002; E0201 for a map that is not of a whole planet. Says N5042,
// W5043.
std::shared_ptr<const light::BodyMap> albedo_map(const PlanetFiles& files, const Vec3& albedo,
                                                 DiagnosticLog& log);
// Returns a map of lights, as above.
std::shared_ptr<const light::BodyMap> night_map(const std::string& path, DiagnosticLog& log);

}  // namespace panwright::workspace
