#include "ephemeris/internal/clocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "base/text.h"

namespace panwright::ephemeris {

namespace {

constexpr double kTtMinusTai = 32.184;

// TAI − UTC at UTC seconds of the calendar, by pairs of offset and date.
double leap_seconds_at(const std::vector<double>& pairs, double utc) {
  double out = pairs[0];
  for (std::size_t i = 0; i + 1 < pairs.size() && pairs[i + 1] <= utc; i += 2) out = pairs[i];
  return out;
}

const std::vector<double>* leap_seconds(const Pool& pool, std::string& problem) {
  const auto* const pairs = pool.numbers("DELTET/DELTA_AT");
  if (pairs != nullptr && pairs->size() >= 2) return pairs;
  problem = "no leap second kernel (.tls) is loaded";
  return nullptr;
}

// Row of a clock's table: ticks, seconds of its time system, seconds per most significant count.
struct Clock {
  const std::vector<double>* rows = nullptr;
  double ticks_per_count = 1;
  bool in_tt = false;

  std::size_t count() const { return rows->size() / 3; }
  double at(std::size_t row, std::size_t column) const { return (*rows)[3 * row + column]; }
  // The last row at or below a value of a column; 0 where none is.
  std::size_t row_of(std::size_t column, double value) const {
    std::size_t low = 0, high = count();
    while (high - low > 1) {
      const std::size_t middle = low + (high - low) / 2;
      (at(middle, column) <= value ? low : high) = middle;
    }
    return low;
  }
};

bool clock_of(const Pool& pool, int clock, Clock& out, std::string& problem) {
  const std::string id = std::to_string(-static_cast<long long>(clock));
  const auto system = pool.number("SCLK01_TIME_SYSTEM_" + id).value_or(1);
  const auto* const moduli = pool.numbers("SCLK01_MODULI_" + id);
  out.rows = pool.numbers("SCLK01_COEFFICIENTS_" + id);
  const double type = pool.number("SCLK_DATA_TYPE_" + id).value_or(1);
  if (type != 1) {
    problem = fmt::format("the clock of {} is of type {}, 1 alone is read", clock, type);
    return false;
  }
  if (out.rows == nullptr || out.count() == 0) {
    problem = fmt::format("no clock kernel (.tsc) of {} is loaded", clock);
    return false;
  }
  out.in_tt = system == 2;
  for (std::size_t i = 1; moduli != nullptr && i < moduli->size(); ++i)
    out.ticks_per_count *= (*moduli)[i];
  if (moduli == nullptr || !(out.ticks_per_count > 0) || (system != 1 && system != 2)) {
    problem = fmt::format("the clock kernel of {} has no moduli, or another time system", clock);
    return false;
  }
  return true;
}

std::optional<double> finite(double value, int clock, std::string& problem) {
  if (std::isfinite(value)) return value;
  problem = fmt::format("the clock kernel of {} gives no time there", clock);
  return std::nullopt;
}

}  // namespace

double tdb_minus_tt(const Pool& pool, double seconds) {
  const double k = pool.number("DELTET/K").value_or(1.657e-3);
  const double eb = pool.number("DELTET/EB").value_or(1.671e-2);
  const auto* const m = pool.numbers("DELTET/M");
  const bool own = m != nullptr && m->size() >= 2;
  const double mean = own ? (*m)[0] + (*m)[1] * seconds : 6.239996 + 1.99096871e-7 * seconds;
  return k * det::sin(mean + eb * det::sin(mean));
}

double tt_of_et(const Pool& pool, double et) {
  double tt = et;
  for (int i = 0; i < 3; ++i) tt = et - tdb_minus_tt(pool, tt);
  return tt;
}

double et_of_tt(const Pool& pool, double tt) { return tt + tdb_minus_tt(pool, tt); }

std::optional<double> et_of_utc(const Pool& pool, std::string_view text, std::string& problem) {
  const auto* const pairs = leap_seconds(pool, problem);
  if (pairs == nullptr) return std::nullopt;
  const auto utc = calendar_seconds(text);
  if (!utc) {
    problem = in_quotes(text) + " is no date, expected YYYY-MM-DDThh:mm:ss";
    return std::nullopt;
  }
  // by the day: second 60 belongs to the day before
  constexpr double kDay = 86400;
  const std::size_t seconds = text.rfind(':');
  const bool leap = seconds != text.npos && text.substr(seconds + 1).starts_with("60");
  const double day = std::floor(((leap ? *utc - 1.5 : *utc) + kDay / 2) / kDay) * kDay - kDay / 2;
  const double offset = pool.number("DELTET/DELTA_T_A").value_or(kTtMinusTai);
  return et_of_tt(pool, *utc + leap_seconds_at(*pairs, day) + offset);
}

std::optional<double> utc_of_et(const Pool& pool, double et, std::string& problem) {
  const auto* const pairs = leap_seconds(pool, problem);
  if (pairs == nullptr) return std::nullopt;
  const double tai = tt_of_et(pool, et) - pool.number("DELTET/DELTA_T_A").value_or(kTtMinusTai);
  double offset = pairs->front();
  for (std::size_t i = 0; i + 1 < pairs->size() && (*pairs)[i + 1] + (*pairs)[i] <= tai; i += 2)
    offset = (*pairs)[i];
  return tai - offset;
}

std::optional<double> et_of_ticks(const Pool& pool, int clock, double ticks, std::string& problem) {
  Clock table;
  if (!clock_of(pool, clock, table, problem)) return std::nullopt;
  const std::size_t row = table.row_of(0, ticks);
  const double time =
      table.at(row, 1) + table.at(row, 2) * (ticks - table.at(row, 0)) / table.ticks_per_count;
  return finite(table.in_tt ? et_of_tt(pool, time) : time, clock, problem);
}

std::optional<double> ticks_of_et(const Pool& pool, int clock, double et, std::string& problem) {
  Clock table;
  if (!clock_of(pool, clock, table, problem)) return std::nullopt;
  const double time = table.in_tt ? tt_of_et(pool, et) : et;
  const std::size_t row = table.row_of(1, time);
  double ticks =
      table.at(row, 0) + (time - table.at(row, 1)) * table.ticks_per_count / table.at(row, 2);
  // rows may leave a gap of time between them
  if (row + 1 < table.count()) ticks = std::min(ticks, table.at(row + 1, 0));
  return finite(ticks, clock, problem);
}

}  // namespace panwright::ephemeris
