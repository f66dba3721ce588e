// Conversion of glTF materials. Private to importers/gltf.
#pragma once

#include "importers/gltf/primitives.h"
#include "importers/gltf/textures.h"

namespace panwright::importers::gltf {

struct BuiltMaterial {
  materials::Material material;
  CadMaterial cad;
  TexcoordChoice texcoords;  // coordinates of its textures
  // true if all of them repeat along u and v; ours do, whatever the file states
  std::array<bool, 2> repeats{true, true};
  double coat_changed = 0;  // share of its light changed by its clearcoat, see changed_share()
  bool invisible = false;   // its alpha is 0, or below the cut-out threshold, everywhere
};

// Returns the material of an index; −1: the default one. Textures only on request.
BuiltMaterial material_of(const tinygltf::Model& model, int index, bool with_textures,
                          TextureReader& textures);

// Returns the texture coordinates needed by a material.
TexcoordChoice texcoords_of(const tinygltf::Model& model, int index);

// Complex refractive index with the exact reflectance nearest to Schlick's curve from f0 at normal
// incidence to 1 at grazing: within 0.041 for any f0.
struct ComplexIndex {
  double n = 1;
  double k = 0;
};
ComplexIndex index_like_schlick(double f0);

}  // namespace panwright::importers::gltf
