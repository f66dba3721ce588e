// Samples of leaves in a region, and those of them that are visible.
#pragma once

#include <cstdint>
#include <vector>

#include "labels/internal/coverage.h"
#include "labels/internal/sample_bits.h"

namespace panwright::labels {

struct LeafBits {
  std::uint32_t leaf = 0;
  SampleBits amodal;
  std::vector<std::uint64_t> visible;  // of the same words; within the image
};

// Returns the samples of all leaves that reach into a region; without those outside `rows` and
// `columns` of its pixels.
//
//   wanted  of each leaf: false: its visible samples may lack those that others hide or not
std::vector<LeafBits> region_bits(const Shown& shown, const Surfaces& surfaces,
                                  const Region& region, const std::vector<char>& wanted);

}  // namespace panwright::labels
