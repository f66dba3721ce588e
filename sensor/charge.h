// Charge that moves along the columns of a detector: smear of frame transfer, blooming.
#pragma once

#include <cstdint>
#include <span>

namespace panwright::sensor {

// Smear of frame transfer: rows shift towards the storage below the last row, and collect light of
// the rows that they pass.
struct Smear {
  double ratio = 0;    // time in a row while shifting / exposure time, 0 to 1
  bool flush = false;  // columns are emptied right before the exposure: only rows below smear
};

// Adds smear to mean electrons of columns, in place: q = s + ratio·Σ of the others (with a flush:
// of those below). Row-major, width*height.
void add_smear(std::span<double> electrons, std::uint32_t width, const Smear& smear);
// Removes it: the inverse, within 1e-13 of the sum of a column. Expects: ratio < 1.
void remove_smear(std::span<double> electrons, std::uint32_t width, const Smear& smear);

// Spreads charge beyond the full well along columns, in place: half of an excess flows up and half
// down, into what room there is. What passes the top flows back; what passes the bottom is lost to
// the register there.
//
//   electrons  whole numbers; row-major, width*height
//   returns    electrons lost: with them the sum stays, exactly
double bloom(std::span<double> electrons, std::uint32_t width, double full_well);

}  // namespace panwright::sensor
