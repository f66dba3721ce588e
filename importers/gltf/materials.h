// Materials of glTF → ours. Private to importers/gltf.
#pragma once

#include "importers/gltf/primitives.h"
#include "importers/gltf/textures.h"

namespace panwright::importers::gltf {

struct BuiltMaterial {
  materials::Material material;
  CadMaterial cad;
  TexcoordChoice texcoords;  // what its textures lie over
  // whether all of them repeat along u and v; ours do, whatever the file says
  std::array<bool, 2> repeats{true, true};
  double coat_changed = 0;  // share of its light that its clearcoat changes, see changed_share()
  bool invisible = false;   // its alpha is 0, or below what is cut out, everywhere
};

// The material of that index; −1: what a surface without one gets. Textures only where asked for.
BuiltMaterial material_of(const tinygltf::Model& model, int index, bool with_textures,
                          TextureReader& textures);

// Which texture coordinates a material needs.
TexcoordChoice texcoords_of(const tinygltf::Model& model, int index);

// Complex refractive index whose exact reflectance is nearest to Schlick's curve from f0 at normal
// incidence to 1 at grazing: within 0.041 of it for any f0.
struct ComplexIndex {
  double n = 1;
  double k = 0;
};
ComplexIndex index_like_schlick(double f0);

}  // namespace panwright::importers::gltf
