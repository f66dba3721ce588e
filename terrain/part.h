// Parts of elevation files: what a terrain takes of each, as rows of heights.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "terrain/dem.h"

namespace panwright::terrain {

// Choice of a part, in the order in which it is applied.
struct PartChoice {
  // Pixels [0], [0] + [2) by [1], [1] + [3) of the file: first column and row, columns and rows.
  std::optional<std::array<std::uint32_t, 4>> pixels;
  // Posts within south, west, north, east: degrees; of a plane y, x, y, x in metres.
  std::optional<std::array<double, 4>> bounds;
  std::uint32_t reduce = 1;  // means of N x N pixels; a rest is left out
  double raise = 0;          // metres, added to heights
  double blend = 0;          // metres: band within the border that leads to the terrain below
};

// An opened elevation file, and what is taken of it. Rows are those of info(): bit-equal to the
// file's where nothing is reduced or raised.
class DemPart {
 public:
  // Fails: E9613 at `place`, which begins the message: nothing is left, beyond the file, or bounds
  // of a polar map.
  static Result<DemPart> of(Dem dem, const PartChoice& choice, const std::string& place,
                            DiagnosticLog& log);
  // All of a file.
  explicit DemPart(Dem dem);

  const DemInfo& info() const { return info_; }  // size and map of the part
  const Dem& dem() const { return dem_; }
  double blend() const { return choice_.blend; }
  const std::string& place() const { return place_; }  // of its text; empty: none
  std::string words() const;  // Choice, for records; empty: all of the file, as it is

  // Gives all rows, as Dem::read().
  bool read(const RowsReceiver& to, DiagnosticLog& log, const Job& job = {}) const;

 private:
  Dem dem_;
  PartChoice choice_;
  std::string place_;
  std::array<std::uint32_t, 4> pixels_{};
  DemInfo info_;
};

}  // namespace panwright::terrain
