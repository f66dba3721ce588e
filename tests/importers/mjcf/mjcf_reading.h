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

inline std::size_t node_index(const scene::Scene& scene, std::string_view name) {
  for (std::size_t i = 0; i < scene.nodes.size(); ++i)
    if (scene.nodes[i].name == name) return i;
  return scene.nodes.size();
}

inline scene::Joint* joint_named(scene::Scene& scene, std::string_view name) {
  for (scene::Joint& joint : scene.joints)
    if (joint.name == name) return &joint;
  return nullptr;
}

}  // namespace panwright::importers
