// Checks and triangles of meshes. Private to importers/gltf.
#pragma once

#include <tiny_gltf.h>

#include <vector>

#include "geometry/mesh.h"
#include "importers/gltf/document.h"

namespace panwright::importers::gltf {

// Checks attributes, counts, formats, targets and material of every primitive. Removes unreadable
// ones from the tree. Reports E6206, E6207, E6211, W6212, W6215, W6009.
void check_meshes(Document& document);

// Texture coordinates of a surface: a set, under KHR_texture_transform.
struct TexcoordChoice {
  int set = -1;  // −1: none
  Vec2 offset{0};
  double rotation = 0;  // radians
  Vec2 scale{1};
  bool operator==(const TexcoordChoice&) const = default;
};

// Skin: the weights of each vertex, in sets of four.
struct SkinWeights {
  std::vector<Vec4> joints;   // V·sets
  std::vector<Vec4> weights;  // V·sets
  std::size_t sets = 0;
};

struct Surface {
  geometry::Mesh mesh;  // normals may be missing
  SkinWeights skin;     // sets = 0: the mesh has none
  bool has_texcoords = false;
  bool skipped = false;  // points or lines
};

// Reads the triangles of one primitive, morphed by the weights. Empty if unreadable, which is
// reported: E6207, E6210, E6002.
//
//   shared  other primitives have the same positions: only the vertices of its triangles are read
Surface surface_of(Document& document, const tinygltf::Primitive& primitive, bool shared,
                   const std::vector<double>& weights, const TexcoordChoice& texcoords,
                   const std::string& object);

// Returns a key of a primitive's data: primitives with equal keys have the same triangles.
std::string surface_key(const tinygltf::Primitive& primitive, const std::vector<double>& weights,
                        const TexcoordChoice& texcoords);

}  // namespace panwright::importers::gltf
