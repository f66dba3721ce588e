// Skinned meshes at rest. Private to importers/gltf.
#pragma once

#include <map>

#include "importers/gltf/primitives.h"
#include "importers/gltf/structs.h"

namespace panwright::importers::gltf {

class SkinPoser {
 public:
  SkinPoser(Document& document, const tinygltf::Model& model);

  // Returns the mesh posed by its joints, in the frame of the scene's root. Vertices without
  // weights do not move. Missing normals are computed. Reports E6207, W6212.
  geometry::MeshShape posed(int skin, const geometry::Mesh& mesh, const SkinWeights& weights);

 private:
  const std::vector<Mat4>& joints_of(int skin);

  Document& document_;
  const tinygltf::Model& model_;
  std::vector<Mat4> world_;  // of glTF's nodes
  std::map<int, std::vector<Mat4>> joints_;
};

}  // namespace panwright::importers::gltf
