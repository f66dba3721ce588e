// Scene → text: any scene as one pxn file of level 1.
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

// What a text calls the texture of a texture: a path relative to the folder of the text.
using TextureName = std::function<std::string(std::size_t texture)>;

// The scene as a text of level 1, in canonical form. Nodes, shapes, materials, frames, keypoints,
// decals and the budget are written out one by one, in metres and radians, each number as the
// shortest text that reads back as the same number. Read again, it gives a scene that is the same
// by scene_difference(), if the scene came from pxn::read.
//
//   scene  sound by scene::check
//   name   none: images are named as their textures
//
// What the language cannot say is changed: names that several materials have get a number, and so
// do those of shapes that a decal could not be told by; braces in names become parentheses; shapes
// at a node with others, all joints of a node but its first, and a root that is moved, get nodes of
// their own; masses of joints are left out; weights that add up to
// more than 1 are scaled to 1 and colours made brighter for it; textures by texture
// coordinates that belong to an instance, and terms of a budget that need others that are absent
// are left out.
[[nodiscard]] std::string to_text(const scene::Scene& scene, const TextureName& name = {});

// Writes the textures of a scene as PNG files, for a text in this folder. Each keeps its texture's
// name where that is a PNG file in the folder or below it that is not there yet, or that holds the
// same texels already; others are called STEM-1.png, STEM-2.png….
//
//   returns  the name of each texture's file
//
// Fails: E0103.
[[nodiscard]] Result<std::vector<std::string>> write_textures(const scene::Scene& scene,
                                                              const std::filesystem::path& text,
                                                              DiagnosticLog& log);

enum class Likeness {
  same,   // field by field, except Source and inputs
  looks,  // what is seen and found: names of nodes and materials, and nodes that move nothing, may
          // differ
};

// Empty when two scenes are alike; the first difference in words otherwise. Numbers are compared
// bit for bit, but for the sign of 0. Shapes, materials and textures may stand in another order,
// and those that nothing uses are not looked at.
std::string scene_difference(const scene::Scene& a, const scene::Scene& b, Likeness likeness);

}  // namespace panwright::pxn
