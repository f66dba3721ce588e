// Digital shape kernels of SPICE: plates of the type-2 segments of a binary DSK.
//
// Sources: NAIF, DAS Required Reading and DSK Required Reading; the layout of segments from the
// latter's description of data type 2.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace panwright::ephemeris {

struct DskPlates {
  int body = 0;                                      // NAIF id of the centre
  int surface = 0;                                   // NAIF id
  int frame = 0;                                     // NAIF id, body-fixed
  std::vector<std::array<double, 3>> vertices;       // km
  std::vector<std::array<std::uint32_t, 3>> plates;  // from 0
};

// Returns whether bytes begin as a binary DSK.
bool is_dsk(std::span<const std::byte> bytes);

// Reads the segments of type 2, in either byte order; others are counted in `skipped`.
//
//   problem  where false: one sentence, what is damaged
// Cost: O(bytes).
bool read_dsk(std::span<const std::byte> bytes, std::vector<DskPlates>& out, std::size_t& skipped,
              std::string& problem);

}  // namespace panwright::ephemeris
