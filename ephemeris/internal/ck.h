// Segments of CK files: attitudes over spacecraft clock ticks. Private to ephemeris.
//
// Source: NAIF, CK Required Reading.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ephemeris/internal/daf.h"
#include "ephemeris/state.h"

namespace panwright::ephemeris {

struct CkLayout {
  int type = 0;
  bool with_rates = false;
  std::size_t count = 0;      // of pointings
  std::size_t intervals = 0;  // of type 3
};

struct Pointing {
  Mat3 from_reference{1};    // takes vectors in axes of the reference frame to the instrument's
  std::optional<Vec3> rate;  // of the instrument, rad/s in axes of the reference frame
};

bool is_ck_type_read(int type);
// Checks counts against the numbers that are there. problem: where false, what is wrong.
bool ck_layout(int type, bool with_rates, const Doubles& data, CkLayout& out, std::string& problem);

// Returns the attitude at ticks; nothing in gaps, or where its numbers are no rotation. Expects: a
// layout of this data, of a type that is read.
std::optional<Pointing> ck_pointing(const CkLayout& layout, const Doubles& data, double ticks);

// Returns the spans of ticks without gaps, in order. Cost: O(intervals · log count).
std::vector<Interval> ck_spans(const CkLayout& layout, const Doubles& data);

}  // namespace panwright::ephemeris
