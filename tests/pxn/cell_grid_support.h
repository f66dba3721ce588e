// CAD files with solar cells, and the check that these are in true metres.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "pxn/pxn.h"

namespace panwright::pxn {

struct CellReading {
  scene::Scene scene;
  DiagnosticLog log;
};

// Reads a file with cells on every instance, or on those chosen by a rule's attributes.
inline CellReading cells_reading(const std::string& name, const std::string& bytes,
                                 const std::string& import, const std::string& rule = "") {
  CellReading out;
  const MemoryFile files[] = {
      {"model/top.pxn",
       "<pangu_model ver=\"1\"><material name=\"c\" preset=\"cells_gaas\"/>"
       "<import file=\"" +
           name + "\" " + import + "><assign " + rule + " material=\"c\"/></import></pangu_model>"},
      {"model/" + name, bytes}};
  auto scene = read_memory(files, {}, out.log);
  EXPECT_TRUE(scene) << to_text(out.log);
  if (scene) out.scene = std::move(*scene);
  EXPECT_EQ(scene::check(out.scene), "");
  return out;
}

// Expects edges of triangles with cells to be as long in texture coordinates as in the world,
// relative to the mesh's size (3.6e-16 on exact faces). Returns their area, m².
inline double expect_true_metres(const scene::Scene& scene, double tolerance = 1e-9) {
  const std::vector<Mat4> world = scene::world_from_nodes(scene);
  double area = 0;
  for (const scene::Instance& instance : scene.instances) {
    if (!scene.materials[static_cast<std::size_t>(instance.material)].cells) continue;
    const auto* shape =
        std::get_if<geometry::MeshShape>(&scene.shapes[static_cast<std::size_t>(instance.shape)]);
    if (shape == nullptr || (*shape)->texcoords.empty()) {
      ADD_FAILURE() << "cells without texture coordinates";
      continue;
    }
    const geometry::Mesh& mesh = **shape;
    std::vector<Vec3> at;
    Vec3 low(HUGE_VAL), high(-HUGE_VAL);
    for (const Vec3& p : mesh.positions) {
      at.emplace_back(world[static_cast<std::size_t>(instance.node)] * Vec4(p, 1));
      low = glm::min(low, at.back());
      high = glm::max(high, at.back());
    }
    double largest = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      area += glm::length(glm::cross(at[b] - at[a], at[c] - at[a])) / 2;
      for (const auto& [i, j] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
        largest = std::max(largest, std::abs(glm::length(at[i] - at[j]) -
                                             glm::length(mesh.texcoords[i] - mesh.texcoords[j])));
    }
    EXPECT_LE(largest, tolerance * glm::length(high - low));
  }
  return area;
}

}  // namespace panwright::pxn
