// Differences between two models, in words.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pan/model.h"

namespace panwright::pan {

// One difference. Records are named as in the file: "node root/dish", "mesh 'hull'".
struct Difference {
  std::string where;
  std::string what;  // "translation: 0 0 1 in a, 0 0 2 in b", or "only in a"
};

struct Differences {
  std::vector<Difference> model;       // visible or addressable
  std::vector<Difference> provenance;  // inputs, version, options, source locations, build identity
  std::vector<Difference> storage;     // compression, sizes of records, the format's version
  std::size_t hidden = 0;              // beyond the limit, counted only

  bool empty() const { return model.empty() && provenance.empty() && storage.empty(); }
  bool same_model() const { return model.empty(); }
};

// Compares two models: nodes by their path of names, meshes, materials, textures, frames,
// keypoints and decals by name, instances by node and mesh; equal names in their order. A mesh's
// positions are compared with its origin added, in double.
//
//   limit    differences kept in each list
//   returns  empty() exactly when the files are equal byte for byte
//
// Expects: both checked(). Cost: O(bytes of both + records · log records).
Differences diff(const Model& a, const Model& b, std::size_t limit = 200);

}  // namespace panwright::pan
