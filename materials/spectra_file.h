// Reader of users' tables of optical constants.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "materials/spectra.h"

namespace panwright::materials {

// Problem of a table.
struct TableProblem {
  std::size_t line = 0;  // from 1; 0: the whole
  std::string message;
};

// Reads n and k at the bands, interpolated linearly between rows, from the text of
//   a file of refractiveindex.info (YAML): `tabulated nk`, `tabulated n`, `tabulated k`, `formula
//   1`
//     and `formula 2` (both of Sellmeier);
//   lines of two or three numbers separated by commas, semicolons or blanks: wavelength in µm, n
//   and
//   k. Lines that begin with #, a quotation mark or a letter are skipped.
// Without k it is 0. Wavelengths rise and reach from 0.45 to 0.65 µm; 0 < n ≤ 100, 0 ≤ k ≤ 100; at
// most 100,000 rows. A byte-order mark is skipped.
//
//   returns  none, with `problem` filled in, for anything else
std::optional<Conductor> read_optical_table(std::string_view text, TableProblem& problem);

}  // namespace panwright::materials
