// Choice among spans of time that overlap: the last one that covers a time holds. Private to
// ephemeris.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "ephemeris/state.h"

namespace panwright::ephemeris {

class Timeline {
 public:
  struct Piece {
    double begin = 0, end = 0;
    std::size_t item = 0;
  };

  // Expects: spans with begin <= end, in ascending order of items: later ones win.
  // Cost: O(n log n).
  static Timeline of(const std::vector<Piece>& spans);

  std::optional<std::size_t> at(double time) const;
  // Ascending; neighbours share bounds, at which the greater item holds.
  const std::vector<Piece>& pieces() const { return pieces_; }

 private:
  std::vector<Piece> pieces_;
};

// Joins spans that touch. Expects: ascending begins.
std::vector<Interval> joined(const std::vector<Interval>& spans);

}  // namespace panwright::ephemeris
