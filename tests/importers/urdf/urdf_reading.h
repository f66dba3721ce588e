// Robot descriptions in memory, read for a test.
#pragma once

#include <string>
#include <string_view>

#include "tests/importers/meshes/mesh_files.h"

namespace panwright::importers {

inline std::unique_ptr<MeshReading> read_robot(const std::string& body,
                                               std::vector<MemoryFile> others = {},
                                               const Options& options = {}) {
  others.insert(others.begin(), {"robot.urdf", "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" +
                                                   body + "\n</robot>\n"});
  return read_meshes(std::move(others), options);
}

}  // namespace panwright::importers
