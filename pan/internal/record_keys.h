// Keys of records, by which those of two models are matched.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <vector>

#include "base/hash.h"
#include "pan/model.h"

namespace panwright::pan::internal {

using Keys = std::vector<Hash128>;  // one per record, all different
using Ids = std::vector<Hash128>;   // one per string

Hash128 joined(std::initializer_list<Hash128> parts);

// Makes equal keys different by counting them.
class Numbering {
 public:
  Hash128 operator()(Hash128 key) { return joined({key, {count_[key]++, 0}}); }

 private:
  std::map<Hash128, std::uint64_t> count_;
};

// Model with the keys of its records.
struct Side {
  const Model& model;
  Ids strings;
  Keys nodes, meshes, materials, textures, frames, instances, keypoints, decals, sheets, levels,
      joints;

  explicit Side(const Model& m);

 private:
  Keys instance_keys(const Model& m) const;
};

}  // namespace panwright::pan::internal
