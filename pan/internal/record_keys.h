// Keys of records, by which those of two models are matched.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <vector>

#include "base/hash.h"
#include "pan/model.h"

namespace panwright::pan::internal {

using Keys = std::vector<Hash128>;  // one per record, all different
using Ids = std::vector<Hash128>;   // one per string

Hash128 joined(std::span<const Hash128> parts);
inline Hash128 joined(std::initializer_list<Hash128> parts) {
  return joined(std::span(parts.begin(), parts.size()));
}

// Makes equal keys different by counting them.
class Numbering {
 public:
  Hash128 operator()(Hash128 key) { return joined({key, {count_[key]++, 0}}); }

 private:
  std::map<Hash128, std::uint64_t> count_;
};

// Model with the keys of its records, of nodes and of the sections that have a key in the layout.
struct Side {
  const Model& model;
  Ids strings;

  explicit Side(const Model& m);
  const Keys& keys(layout::SectionKind kind) const { return keys_[static_cast<std::size_t>(kind)]; }

 private:
  Keys keys_of(layout::SectionKind kind) const;
  std::array<Keys, layout::kLastKind + 1> keys_;
};

}  // namespace panwright::pan::internal
