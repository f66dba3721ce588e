// Epochs against published instants: the GPS epoch, J2000, leap seconds.
#include "scenario/time.h"

#include <gtest/gtest.h>

#include <cmath>

namespace panwright::scenario::time_test {
namespace {

Epoch epoch(const std::string& text, TimeSystem system) {
  std::string problem;
  const auto out = parse_epoch(text, system, problem);
  EXPECT_TRUE(out) << problem;
  return out.value_or(Epoch{});
}

std::string problem_of(const std::string& text, TimeSystem system) {
  std::string problem;
  EXPECT_FALSE(parse_epoch(text, system, problem)) << text;
  return problem;
}

TEST(Time, SameInstants) {
  // GPS time began at 1980-01-06 UTC, when TAI − UTC was 19 s
  EXPECT_EQ(epoch("1980-01-06T00:00:00", TimeSystem::utc),
            epoch("1980-01-06T00:00:00", TimeSystem::gps));
  // J2000.0 = 2000-01-01T12:00:00 TT = 11:58:55.816 UTC
  EXPECT_NEAR(seconds_between(epoch("2000-01-01T12:00:00", TimeSystem::tt),
                              epoch("2000-01-01T11:58:55.816", TimeSystem::utc)),
              0, 1e-12);
  EXPECT_EQ(epoch("2020-060T00:00:00Z", TimeSystem::utc),
            epoch("2020-02-29T00:00:00", TimeSystem::utc));
  EXPECT_EQ(seconds_between(epoch("2026-01-01T00:00:00", TimeSystem::tai),
                            epoch("2026-01-01T00:00:00", TimeSystem::utc)),
            37);
}

TEST(Time, LeapSeconds) {
  const Epoch before = epoch("2016-12-31T23:59:59", TimeSystem::utc);
  const Epoch during = epoch("2016-12-31T23:59:60.5", TimeSystem::utc);
  const Epoch after = epoch("2017-01-01T00:00:00", TimeSystem::utc);
  EXPECT_EQ(seconds_between(before, after), 2);
  EXPECT_EQ(seconds_between(before, during), 1.5);
  EXPECT_EQ(epoch_text(during, TimeSystem::utc), "2016-12-31T23:59:60.5");
  EXPECT_EQ(epoch_text(after, TimeSystem::utc), "2017-01-01T00:00:00");
  EXPECT_NE(problem_of("2016-12-30T23:59:60", TimeSystem::utc).find("leap second"),
            std::string::npos);
  EXPECT_NE(problem_of("2016-12-31T23:59:60", TimeSystem::tai), "");
  EXPECT_NE(problem_of("1971-12-31T00:00:00", TimeSystem::utc).find("1972"), std::string::npos);
}

TEST(Time, BarycentricTime) {
  // Astronomical Almanac: TDB − TT ≈ 0.001657 sin g + 0.000022 sin(L − LJ), g = 357.53° +
  // 0.98560028° (JD − 2451545.0); the second term is left out: within 30 µs
  for (const int day : {0, 91, 182, 275, 3000}) {
    const Epoch tt = later(epoch("2000-01-01T12:00:00", TimeSystem::tt), day * 86400.0);
    const Epoch as_tdb = epoch(epoch_text(tt, TimeSystem::tt), TimeSystem::tdb);
    const double g = (357.53 + 0.98560028 * day) * M_PI / 180;
    EXPECT_NEAR(seconds_between(as_tdb, tt), 0.001657 * std::sin(g) + 0.000014 * std::sin(2 * g),
                3e-5)
        << day;
  }
}

TEST(Time, TextsRoundTrip) {
  for (const TimeSystem system :
       {TimeSystem::utc, TimeSystem::tai, TimeSystem::tt, TimeSystem::tdb, TimeSystem::gps})
    for (const std::string text :
         {"1996-12-18T12:00:00.331", "2100-02-28T23:59:59.999999999", "1999-12-31T23:59:59",
          "2024-02-29T00:00:00", "2015-06-30T23:59:59.25"})
      EXPECT_EQ(epoch_text(epoch(text, system), system), text) << time_system_name(system);
  EXPECT_EQ(epoch_text(epoch("1900-03-01T00:00:00", TimeSystem::tt), TimeSystem::tt),
            "1900-03-01T00:00:00");
}

TEST(Time, WrongTexts) {
  for (const std::string text :
       {"", "2026", "2026-13-01T00:00:00", "2025-02-29T00:00:00", "2026-366T00:00:00",
        "2026-01-01 00:00:00", "2026-01-01T24:00:00", "2026-01-01T00:60:00", "2026-1-1T00:00:00",
        "2026-01-01T00:00:00 UTC", "2026-01-01T00:00:00,5"})
    EXPECT_NE(problem_of(text, TimeSystem::utc), "") << text;
  EXPECT_FALSE(time_system_named("UT1"));
}

}  // namespace
}  // namespace panwright::scenario::time_test
