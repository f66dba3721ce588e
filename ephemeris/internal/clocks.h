// Leap seconds and spacecraft clocks of text kernels. Private to ephemeris.
//
// Source: NAIF, Time Required Reading and SCLK Required Reading (clocks of type 1).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "ephemeris/internal/pool.h"

namespace panwright::ephemeris {

// TDB − TT at ET or, as accurately, at TT past J2000: K sin(M + EB sin M) of the leap second
// kernel, of naif0012 where there is none.
double tdb_minus_tt(const Pool& pool, double seconds);
double tt_of_et(const Pool& pool, double et);
double et_of_tt(const Pool& pool, double tt);

// Return nothing, and the problem, where the kernels lack what they need.
std::optional<double> et_of_utc(const Pool& pool, std::string_view text, std::string& problem);
// UTC seconds past J2000 of a calendar without leap seconds.
std::optional<double> utc_of_et(const Pool& pool, double et, std::string& problem);

// Encoded ticks of a clock, without partitions. clock: of the spacecraft, as −82.
std::optional<double> et_of_ticks(const Pool& pool, int clock, double ticks, std::string& problem);
std::optional<double> ticks_of_et(const Pool& pool, int clock, double et, std::string& problem);

}  // namespace panwright::ephemeris
