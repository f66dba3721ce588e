// Labelled parts of the targets of a world.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "world/world.h"

namespace panwright::labels {

// Part that the user names, beside those that models name.
struct ChosenPart {
  std::string label;  // not empty
  // Path of its node from the target's name, as "client/root/body/wing"; or its end, as "wing".
  // Several nodes make one part.
  std::string node;
  bool operator==(const ChosenPart&) const = default;
};

// Target or part, of whatever state.
struct NamedThing {
  std::uint32_t target = 0;          // in the world
  std::string label;                 // empty: the whole target
  std::vector<std::uint32_t> nodes;  // with all that is below them; of a target: its root
};

// The things of a world: targets in their order, each followed by its parts in the order of their
// first nodes. All of one label are one part. Changes with the models alone.
struct Things {
  std::vector<NamedThing> things;
  // Surfaces that belong to the same things are one leaf. By target and node.
  std::vector<std::vector<std::uint32_t>> leaf_of;
  std::vector<std::vector<std::uint32_t>> of_leaf;  // things of each leaf, ascending
};

// Fails: E9005 for a chosen part without a node.
Result<Things> named_things(const world::World& world, const std::vector<ChosenPart>& chosen,
                            DiagnosticLog& log);

}  // namespace panwright::labels
