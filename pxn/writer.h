// Writer of any scene as one pxn file of level 1.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Name of a texture in a text: a path relative to the text's folder.
using TextureName = std::function<std::string(std::size_t texture)>;

// Writes the scene as a text of level 1, in canonical form. Nodes, shapes, materials, frames,
// keypoints, decals and the budget are written one by one, in metres and radians. Each number is
// the shortest text that reads back as the same number. Reading it gives the same scene by
// scene_difference(), if the scene came from pxn::read.
//
//   scene  valid by scene::check
//   name   none: images are named after their textures
//
// Changes, for the limits of the language: repeated names of materials, and ambiguous ones of
// shapes with decals, get a number; braces in names become parentheses. Shapes that share a node,
// all joints of a node but its first, and a moved root get nodes of their own. Weights that add up
// to more than 1 are scaled to 1, with brighter colours. Left out: masses of joints, textures of
// instances by texture coordinates, and terms of a budget without their partners.
[[nodiscard]] std::string to_text(const scene::Scene& scene, const TextureName& name = {});

// Writes the textures of a scene as PNG files, for a text in this folder. Each keeps its texture's
// name if that is a PNG file in or below the folder that does not exist or holds the same texels;
// others are named STEM-1.png, STEM-2.png….
//
//   returns  the name of each texture's file
//
// Fails: E0103.
[[nodiscard]] Result<std::vector<std::string>> write_textures(const scene::Scene& scene,
                                                              const std::filesystem::path& text,
                                                              DiagnosticLog& log);

enum class Likeness {
  same,   // field by field, except Source and inputs
  looks,  // visible and named parts; names of nodes and materials, and nodes that move nothing, may
          // differ
};

// Compares two scenes; returns the first difference in words, or an empty string. Numbers are
// compared bit for bit, except the sign of 0. Shapes, materials and textures may be in another
// order, and unused ones are ignored.
std::string scene_difference(const scene::Scene& a, const scene::Scene& b, Likeness likeness);

}  // namespace panwright::pxn
