// Double precision array files of SPICE: binary, in either byte order, and transfer files. Private
// to ephemeris.
//
// Source: NAIF, DAF Required Reading.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ephemeris/internal/doubles.h"

namespace panwright::ephemeris {

enum class DafKind : std::uint8_t { spk, ck, pck };

struct DafSegment {
  std::string name;
  double begin = 0, end = 0;              // its times, seconds or ticks: finite, begin <= end
  std::array<std::int32_t, 4> numbers{};  // of its kind; 3 of a PCK
  Doubles data;
};

struct Daf {
  DafKind kind = DafKind::spk;
  std::vector<DafSegment> segments;       // in the order of the file
  std::vector<std::vector<double>> kept;  // numbers of a transfer file, which segments view
};

// Returns whether bytes begin as a binary or transfer file.
bool is_daf(std::span<const std::byte> bytes);

// Reads the list of segments; those of a binary file view its bytes.
//
//   problem  where false: one sentence, what is damaged
// Cost: O(segments); of a transfer file O(bytes), and 4 times its size of memory at most.
bool read_daf(std::span<const std::byte> bytes, Daf& out, std::string& problem);

}  // namespace panwright::ephemeris
