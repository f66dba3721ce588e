// Segments of SPK and binary PCK files. Private to ephemeris.
//
// Sources: NAIF, SPK Required Reading and PCK Required Reading; Krogh, Variable order integrators
// (modified difference arrays: their accelerations are polynomials, integrated here by Gauss and
// Legendre's rule, which is exact for them).
#pragma once

#include <string>

#include "ephemeris/internal/daf.h"
#include "ephemeris/state.h"

namespace panwright::ephemeris {

// Layout of the numbers of a segment.
struct SpkLayout {
  int type = 0;            // 0: a type that is not read
  std::size_t count = 0;   // records, states or intervals
  std::size_t size = 0;    // numbers of a record; of types 1 and 21 terms of a difference array
  std::size_t window = 0;  // nodes of an interpolation
  int subtype = 0;
};

// Returns whether a type is read.
bool is_spk_type_read(int type);
// Checks counts against the numbers that are there.
//
//   problem  where false: what is wrong
bool spk_layout(int type, const Doubles& data, SpkLayout& out, std::string& problem);

// Evaluates a segment. False: its numbers give no finite state. Expects: a layout of this data, of
// a type that is read.
// Cost: O(log count); 40 to 500 ns.
bool spk_state(const SpkLayout& layout, const Doubles& data, double et, State& out);

// Evaluates angles of a binary PCK of type 2: phi, delta and w as position, their rates as
// velocity.
inline bool pck_angles(const SpkLayout& layout, const Doubles& data, double et, State& out) {
  return spk_state(layout, data, et, out);
}

}  // namespace panwright::ephemeris
