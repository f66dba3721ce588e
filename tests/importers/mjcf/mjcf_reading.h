// MuJoCo models in memory, read for a test.
#pragma once

#include <string>
#include <string_view>

#include "tests/importers/meshes/mesh_files.h"

namespace panwright::importers {

inline std::unique_ptr<MeshReading> read_mujoco(const std::string& inside,
                                                std::vector<MemoryFile> others = {},
                                                const Options& options = {}) {
  others.insert(others.begin(), {"model.xml", "<?xml version=\"1.0\"?>\n<mujoco model=\"m\">\n" +
                                                  inside + "\n</mujoco>\n"});
  return read_meshes(std::move(others), options);
}

}  // namespace panwright::importers
