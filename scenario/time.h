// Epochs in TAI, and their texts in the time systems of trajectory files.
//
// Sources: CCSDS 301.0-B-4 (text forms A and B); leap seconds of IERS Bulletin C up to number 70;
// TDB − TT = 1.657 ms · sin(M + 0.01671 sin M), M = 6.239996 + 1.99096871e-7 · t, as in the leap
// second kernels of NAIF: within 30 µs.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace panwright::scenario {

enum class TimeSystem : std::uint8_t { utc, tai, tt, tdb, gps };

// Returns "UTC"…
std::string_view time_system_name(TimeSystem system);
// Any letter case; nothing for others, as UT1.
std::optional<TimeSystem> time_system_named(std::string_view name);

// Instant: seconds after 2000-01-01T00:00:00 TAI.
struct Epoch {
  std::int64_t seconds = 0;
  double fraction = 0;  // in [0, 1)
  auto operator<=>(const Epoch&) const = default;
};

// Returns to − from, seconds. Exact but for one rounding.
double seconds_between(const Epoch& from, const Epoch& to);
// Expects: finite seconds, of less than 1e15.
Epoch later(const Epoch& epoch, double seconds);

// Parses "YYYY-MM-DDThh:mm:ss[.d…][Z]" or "YYYY-DDDThh:mm:ss[.d…][Z]". Seconds of 60 are read where
// UTC has them.
//
//   problem  where there is no epoch: one lower-case sentence
std::optional<Epoch> parse_epoch(std::string_view text, TimeSystem system, std::string& problem);

// Returns "2026-01-01T12:00:00.5": up to 9 decimals, without the name of the system. Before 1972
// UTC is written with an offset of 10 s.
std::string epoch_text(const Epoch& epoch, TimeSystem system);

// Returns seconds of UTC after 2000-01-01T12:00:00, without leap seconds: UT1 within 0.9 s.
double utc_seconds(const Epoch& epoch);

// Returns whether the leap seconds of an epoch are known; after 2026-06-30 the last offset, 37 s,
// is assumed.
bool leap_seconds_known(const Epoch& epoch);

}  // namespace panwright::scenario
