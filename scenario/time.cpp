#include "scenario/time.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "base/math.h"
#include "base/text.h"

namespace panwright::scenario {

namespace {

constexpr std::int64_t kDay = 86400;
constexpr std::array<std::string_view, 5> kSystemNames = {"UTC", "TAI", "TT", "TDB", "GPS"};
constexpr int kTtMilliseconds = 32184;  // TT − TAI
constexpr std::int64_t kGps = 19;       // TAI − GPS

// Days after 2000-01-01 of a date of the Gregorian calendar (Hinnant's algorithm).
constexpr std::int64_t day_of(std::int64_t year, std::int64_t month, std::int64_t day) {
  year -= month <= 2 ? 1 : 0;
  const std::int64_t era = (year >= 0 ? year : year - 399) / 400;
  const std::int64_t of_era = year - era * 400;
  const std::int64_t of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 730425;
}
static_assert(day_of(2000, 1, 1) == 0 && day_of(1999, 12, 31) == -1 && day_of(2000, 3, 1) == 60);

struct Date {
  std::int64_t year, month, day;
};

Date date_of(std::int64_t days) {
  days += 730425;
  const std::int64_t era = (days >= 0 ? days : days - 146096) / 146097;
  const std::int64_t of_era = days - era * 146097;
  const std::int64_t year = (of_era - of_era / 1460 + of_era / 36524 - of_era / 146096) / 365;
  const std::int64_t of_year = of_era - (365 * year + year / 4 - year / 100);
  const std::int64_t shifted = (5 * of_year + 2) / 153;
  const std::int64_t month = shifted + (shifted < 10 ? 3 : -9);
  return {year + era * 400 + (month <= 2 ? 1 : 0), month, of_year - (153 * shifted + 2) / 5 + 1};
}

// TAI − UTC from the begin of a day on.
struct LeapSecond {
  std::int64_t day;
  std::int64_t offset;
};
constexpr LeapSecond kLeapSeconds[] = {
    {day_of(1972, 1, 1), 10}, {day_of(1972, 7, 1), 11}, {day_of(1973, 1, 1), 12},
    {day_of(1974, 1, 1), 13}, {day_of(1975, 1, 1), 14}, {day_of(1976, 1, 1), 15},
    {day_of(1977, 1, 1), 16}, {day_of(1978, 1, 1), 17}, {day_of(1979, 1, 1), 18},
    {day_of(1980, 1, 1), 19}, {day_of(1981, 7, 1), 20}, {day_of(1982, 7, 1), 21},
    {day_of(1983, 7, 1), 22}, {day_of(1985, 7, 1), 23}, {day_of(1988, 1, 1), 24},
    {day_of(1990, 1, 1), 25}, {day_of(1991, 1, 1), 26}, {day_of(1992, 7, 1), 27},
    {day_of(1993, 7, 1), 28}, {day_of(1994, 7, 1), 29}, {day_of(1996, 1, 1), 30},
    {day_of(1997, 7, 1), 31}, {day_of(1999, 1, 1), 32}, {day_of(2006, 1, 1), 33},
    {day_of(2009, 1, 1), 34}, {day_of(2012, 7, 1), 35}, {day_of(2015, 7, 1), 36},
    {day_of(2017, 1, 1), 37}};
constexpr std::int64_t kKnownUntil = day_of(2026, 7, 1);

// The entry that holds on a day of UTC; null before 1972.
const LeapSecond* leap_of(std::int64_t day) {
  const auto* const next = std::upper_bound(
      std::begin(kLeapSeconds), std::end(kLeapSeconds), day,
      [](std::int64_t value, const LeapSecond& entry) { return value < entry.day; });
  return next == std::begin(kLeapSeconds) ? nullptr : next - 1;
}

bool ends_with_leap_second(std::int64_t day) {
  return std::ranges::any_of(kLeapSeconds, [&](const LeapSecond& entry) {
    return entry.day == day + 1 && entry.offset > 10;
  });
}

// TDB − TT at seconds after 2000-01-01T00:00:00.
double tdb_from_tt(double seconds) {
  const double m = 6.239996 + 1.99096871e-7 * (seconds - kDay / 2);
  return 1.657e-3 * det::sin(m + 1.671e-2 * det::sin(m));
}

Epoch sum(const Epoch& epoch, std::int64_t seconds, double fraction) {
  const double all = epoch.fraction + fraction;
  const double whole = std::floor(all);
  double rest = all - whole;
  std::int64_t more = static_cast<std::int64_t>(whole);
  if (rest >= 1) {  // rounding of a tiny negative one
    rest = 0;
    ++more;
  }
  return {epoch.seconds + seconds + more, rest};
}

Epoch milliseconds_later(const Epoch& epoch, int milliseconds) {
  return sum(epoch, milliseconds / 1000, milliseconds % 1000 / 1000.0);
}

double rough(const Epoch& epoch) { return static_cast<double>(epoch.seconds) + epoch.fraction; }

// Reader of digits from the left.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}
  bool digits(std::size_t count, std::int64_t& value) {
    if (text_.size() < count) return false;
    value = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (text_[i] < '0' || text_[i] > '9') return false;
      value = 10 * value + (text_[i] - '0');
    }
    text_.remove_prefix(count);
    return true;
  }
  bool mark(char c) {
    if (!text_.starts_with(c)) return false;
    text_.remove_prefix(1);
    return true;
  }
  std::string_view rest() const { return text_; }

 private:
  std::string_view text_;
};

struct Calendar {
  std::int64_t day = 0;     // after 2000-01-01
  std::int64_t second = 0;  // of the day, 0 to 86400
  double fraction = 0;
};

bool is_leap_year(std::int64_t year) { return day_of(year + 1, 1, 1) - day_of(year, 1, 1) == 366; }

bool scan_date(Scanner& scanner, std::int64_t& day, std::string& problem) {
  std::int64_t year = 0, month = 1, of_month = 1;
  if (!scanner.digits(4, year) || !scanner.mark('-')) return false;
  Scanner by_year = scanner;
  std::int64_t of_year = 0;
  if (by_year.digits(3, of_year) && by_year.rest().starts_with('T')) {
    if (of_year < 1 || of_year > (is_leap_year(year) ? 366 : 365)) {
      problem = fmt::format("{} has no day {}", year, of_year);
      return false;
    }
    scanner = by_year;
    day = day_of(year, 1, 1) + of_year - 1;
    return true;
  }
  if (!scanner.digits(2, month) || !scanner.mark('-') || !scanner.digits(2, of_month)) return false;
  const std::int64_t next = month == 12 ? day_of(year + 1, 1, 1) : day_of(year, month + 1, 1);
  if (month < 1 || month > 12 || of_month < 1 || of_month > next - day_of(year, month, 1)) {
    problem = fmt::format("there is no day {:04}-{:02}-{:02}", year, month, of_month);
    return false;
  }
  day = day_of(year, month, of_month);
  return true;
}

bool scan(std::string_view text, TimeSystem system, Calendar& out, std::string& problem) {
  Scanner scanner(text);
  std::int64_t hour = 0, minute = 0, second = 0;
  if (!scan_date(scanner, out.day, problem)) return false;
  if (!scanner.mark('T') || !scanner.digits(2, hour) || !scanner.mark(':') ||
      !scanner.digits(2, minute) || !scanner.mark(':') || !scanner.digits(2, second))
    return false;
  if (scanner.mark('.')) {
    std::string digits = "0.";
    std::int64_t digit = 0;
    while (scanner.digits(1, digit)) digits.push_back(static_cast<char>('0' + digit));
    out.fraction = parse_double(digits + "0").value_or(0);
    if (out.fraction >= 1) out.fraction = 1 - 0x1p-53;
  }
  scanner.mark('Z');
  if (!scanner.rest().empty()) return false;
  const bool leap = second == 60 && hour == 23 && minute == 59 && system == TimeSystem::utc &&
                    ends_with_leap_second(out.day);
  if (hour > 23 || minute > 59 || (second > 59 && !leap)) {
    problem = fmt::format("there is no time {:02}:{:02}:{:02}{}", hour, minute, second,
                          second == 60 ? ": no leap second is there" : "");
    return false;
  }
  out.second = hour * 3600 + minute * 60 + second;
  return true;
}

}  // namespace

std::string_view time_system_name(TimeSystem system) {
  return kSystemNames[static_cast<std::size_t>(system)];
}

std::optional<TimeSystem> time_system_named(std::string_view name) {
  std::string upper(name);
  for (char& c : upper)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  for (std::size_t i = 0; i < kSystemNames.size(); ++i)
    if (kSystemNames[i] == upper) return static_cast<TimeSystem>(i);
  return std::nullopt;
}

double seconds_between(const Epoch& from, const Epoch& to) {
  return static_cast<double>(to.seconds - from.seconds) + (to.fraction - from.fraction);
}

Epoch later(const Epoch& epoch, double seconds) {
  const double whole = std::floor(seconds);
  return sum(epoch, static_cast<std::int64_t>(whole), seconds - whole);
}

std::optional<Epoch> parse_epoch(std::string_view text, TimeSystem system, std::string& problem) {
  Calendar calendar;
  problem.clear();
  if (!scan(text, system, calendar, problem)) {
    if (problem.empty()) problem = "expected YYYY-MM-DDThh:mm:ss or YYYY-DDDThh:mm:ss";
    problem = in_quotes(text) + " is no epoch: " + problem;
    return std::nullopt;
  }
  const Epoch read{calendar.day * kDay + calendar.second, calendar.fraction};
  switch (system) {
    case TimeSystem::utc: {
      const LeapSecond* const leap = leap_of(calendar.day);
      if (leap == nullptr) {
        problem = in_quotes(text) + ": UTC before 1972 has no whole leap seconds; write TAI or TT";
        return std::nullopt;
      }
      return sum(read, leap->offset, 0);
    }
    case TimeSystem::tai:
      return read;
    case TimeSystem::gps:
      return sum(read, kGps, 0);
    case TimeSystem::tt:
      return milliseconds_later(read, -kTtMilliseconds);
    case TimeSystem::tdb: {
      const double first = tdb_from_tt(rough(read));
      return milliseconds_later(sum(read, 0, -tdb_from_tt(rough(read) - first)), -kTtMilliseconds);
    }
  }
  return std::nullopt;
}

std::string epoch_text(const Epoch& given, TimeSystem system) {
  constexpr double kDigits = 1e9;
  Epoch shown = given;
  bool in_leap = false;
  if (system == TimeSystem::gps) shown = sum(given, -kGps, 0);
  if (system == TimeSystem::tt || system == TimeSystem::tdb)
    shown = milliseconds_later(given, kTtMilliseconds);
  if (system == TimeSystem::tdb) shown = sum(shown, 0, tdb_from_tt(rough(shown)));
  shown = {shown.seconds, std::round(shown.fraction * kDigits)};
  if (shown.fraction >= kDigits) shown = {shown.seconds + 1, 0};
  if (system == TimeSystem::utc) {
    std::int64_t offset = 10;
    for (std::size_t i = 1; i < std::size(kLeapSeconds); ++i) {
      const std::int64_t begin = kLeapSeconds[i].day * kDay + kLeapSeconds[i].offset;
      if (shown.seconds >= begin) offset = kLeapSeconds[i].offset;
      in_leap = in_leap || shown.seconds == begin - 1;
    }
    shown.seconds -= offset + (in_leap ? 1 : 0);
  }
  const std::int64_t day = (shown.seconds - (shown.seconds < 0 ? kDay - 1 : 0)) / kDay;
  const std::int64_t second = shown.seconds - day * kDay;
  const Date date = date_of(day);
  std::string out =
      fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", date.year, date.month, date.day,
                  second / 3600, second / 60 % 60, second % 60 + (in_leap ? 1 : 0));
  if (shown.fraction > 0) {
    out += fmt::format(".{:09}", static_cast<std::int64_t>(shown.fraction));
    out.erase(out.find_last_not_of('0') + 1);
  }
  return out;
}

double utc_seconds(const Epoch& epoch) {
  std::int64_t offset = kLeapSeconds[0].offset;
  for (const LeapSecond& leap : kLeapSeconds)
    if (epoch.seconds >= leap.day * kDay + leap.offset) offset = leap.offset;
  return seconds_between({kDay / 2 + offset, 0}, epoch);
}

bool leap_seconds_known(const Epoch& epoch) {
  return epoch.seconds < kKnownUntil * kDay + std::end(kLeapSeconds)[-1].offset;
}

}  // namespace panwright::scenario
