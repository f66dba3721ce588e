#include "pxn/expression/units.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "pxn/text/characters.h"

namespace panwright::pxn {

namespace {

using schemas::Dimension;

// π/180, π/10800 and π/648000 as sums of two doubles
constexpr Unit kUnits[] = {
    {"m", Dimension::length, 1, 0, 1, 0},
    {"mm", Dimension::length, 1, -3, 1e-3, 0},
    {"cm", Dimension::length, 1, -2, 1e-2, 0},
    {"km", Dimension::length, 1, 3, 1e3, 0},
    {"um", Dimension::length, 1, -6, 1e-6, 0},
    {"\u00b5m", Dimension::length, 1, -6, 1e-6, 0},  // micro sign
    {"\u03bcm", Dimension::length, 1, -6, 1e-6, 0},  // Greek letter
    {"nm", Dimension::length, 1, -9, 1e-9, 0},
    {"in", Dimension::length, 254, -4, 0.0254, 0},
    {"ft", Dimension::length, 3048, -4, 0.3048, 0},
    {"deg", Dimension::angle, 0, 0, 0x1.1df46a2529d39p-6, 0x1.5c1d8becdd291p-62},
    {"rad", Dimension::angle, 1, 0, 1, 0},
    {"mrad", Dimension::angle, 1, -3, 1e-3, 0},
    {"urad", Dimension::angle, 1, -6, 1e-6, 0},
    {"\u00b5rad", Dimension::angle, 1, -6, 1e-6, 0},
    {"\u03bcrad", Dimension::angle, 1, -6, 1e-6, 0},
    {"arcmin", Dimension::angle, 0, 0, 0x1.3104b57cf96a3p-12, 0x1.29a17aa5904f3p-66},
    {"arcsec", Dimension::angle, 0, 0, 0x1.455a5b2ff8f9dp-18, 0x1.c2b0fa39df2fdp-74},
    {"%", Dimension::ratio, 1, -2, 1e-2, 0},
    {"ppm", Dimension::ratio, 1, -6, 1e-6, 0},
    {"px", Dimension::pixels, 1, 0, 1, 0},
};

// A decimal number taken apart: ±value·10^exponent.
struct Decimal {
  std::size_t length = 0;  // bytes; 0: this is no number
  bool negative = false;
  std::string_view mantissa;  // without the sign
  std::int64_t exponent = 0;  // of the last digit of the mantissa
  std::uint64_t value = 0;    // of its digits
  bool exact = true;          // false: they are more than `value` holds
};

Decimal decimal_at(std::string_view text) {
  Decimal out;
  const char* at = text.data();
  const char* const end = at + text.size();
  if (at < end && (*at == '-' || *at == '+')) out.negative = *at++ == '-';
  const char* const first = at;
  bool point = false;
  std::size_t digits = 0;
  for (; at < end; ++at) {
    if (is_digit(*at)) {
      ++digits;
      if (point) --out.exponent;
      // 10^16 · 3048 is below 2^64
      if (out.value >= 1'000'000'000'000'000)
        out.exact = false;
      else
        out.value = out.value * 10 + static_cast<std::uint64_t>(*at - '0');
    } else if (*at == '.' && !point) {
      point = true;
    } else {
      break;
    }
  }
  if (digits == 0) return out;
  out.mantissa = {first, static_cast<std::size_t>(at - first)};
  out.length = static_cast<std::size_t>(at - text.data());
  if (at == end || (*at != 'e' && *at != 'E')) return out;
  ++at;
  const bool down = at < end && *at == '-';
  if (at < end && (*at == '-' || *at == '+')) ++at;
  if (at == end || !is_digit(*at)) return out;
  std::int64_t exponent = 0;
  for (; at < end && is_digit(*at); ++at)
    exponent = std::min<std::int64_t>(exponent * 10 + (*at - '0'), 1'000'000'000'000);
  out.exponent += down ? -exponent : exponent;
  out.length = static_cast<std::size_t>(at - text.data());
  return out;
}

constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                              1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                              1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

// x·times·10^shift, with |shift| up to 22.
double scaled(double x, std::uint32_t times, int shift) {
  const bool large = std::fabs(x) > 1e290;  // the product may not be finite where the whole is
  if (shift >= 0) return large ? x * kPowers[shift] * times : x * times * kPowers[shift];
  return large ? x / kPowers[-shift] * times : x * times / kPowers[-shift];
}

// The digits of a mantissa times a small number, as digits.
std::string multiplied(std::string_view mantissa, std::uint32_t times) {
  std::string out;
  out.reserve(mantissa.size() + 4);
  std::uint32_t carry = 0;
  for (std::size_t i = mantissa.size(); i-- > 0;) {
    if (mantissa[i] == '.') continue;
    carry += static_cast<std::uint32_t>(mantissa[i] - '0') * times;
    out += static_cast<char>('0' + carry % 10);
    carry /= 10;
  }
  for (; carry > 0; carry /= 10) out += static_cast<char>('0' + carry % 10);
  std::reverse(out.begin(), out.end());
  return out;
}

}  // namespace

std::span<const Unit> all_units() { return kUnits; }

const Unit* find_unit(std::string_view name) {
  const auto found = std::find_if(std::begin(kUnits), std::end(kUnits),
                                  [&](const Unit& unit) { return unit.name == name; });
  return found == std::end(kUnits) ? nullptr : found;
}

const Unit* find_unit(Dimension dimension, double factor) {
  const auto found = std::find_if(std::begin(kUnits), std::end(kUnits), [&](const Unit& unit) {
    return unit.dimension == dimension && unit.factor == factor;
  });
  return found == std::end(kUnits) ? nullptr : found;
}

std::size_t number_length(std::string_view text) { return decimal_at(text).length; }

std::optional<double> read_number(std::string_view number, const Unit* unit) {
  if (unit == nullptr || (unit->times == 1 && unit->shift == 0)) return parse_double(number);
  if (unit->times == 0) {
    const std::optional<double> x = parse_double(number);
    return x ? std::optional(to_si(*x, *unit)) : std::nullopt;
  }
  const Decimal decimal = decimal_at(number);
  if (decimal.length != number.size() || number.empty()) return std::nullopt;
  const std::int64_t exponent = decimal.exponent + unit->shift;
  const std::uint64_t whole = decimal.value * unit->times;
  // both are exact, so that the quotient or product is rounded once
  if (decimal.exact && whole <= (std::uint64_t{1} << 53) && exponent >= -22 && exponent <= 22) {
    const auto x = static_cast<double>(whole);
    const double size = exponent < 0 ? x / kPowers[-exponent] : x * kPowers[exponent];
    return decimal.negative ? -size : size;
  }
  return parse_double(fmt::format("{}{}e{}", decimal.negative ? "-" : "",
                                  multiplied(decimal.mantissa, unit->times), exponent));
}

std::optional<double> read_length(std::string_view number, const Unit& unit, const Unit& in) {
  const Unit ratio{unit.name, unit.dimension, unit.times, unit.shift - in.shift, 0, 0};
  const bool same = unit.times == in.times;
  const Unit shifted{unit.name, unit.dimension, 1, ratio.shift, 0, 0};
  const auto read = read_number(number, same ? &shifted : &ratio);
  return read && !same && in.times != 1 ? std::optional(*read / in.times) : read;
}

double to_si(double x, const Unit& unit) {
  if (unit.times != 0) return scaled(x, unit.times, unit.shift);
  const double product = x * unit.factor;
  const double rest = std::fma(x, unit.factor, -product);
  return product + (rest + x * unit.low);
}

double from_si(double si, const Unit& unit) {
  const double quotient =
      unit.times != 0 ? scaled(si, 1, -unit.shift) / unit.times : si / unit.factor;
  if (unit.times == 1 && unit.shift == 0) return si;
  const auto shorter = parse_double(fmt::format("{:.15g}", quotient));
  return shorter && to_si(*shorter, unit) == si ? *shorter : quotient;
}

double in_unit(double x, const Unit& from, const Unit& to) {
  if (from.factor == to.factor) return x;
  const double product = scaled(x, from.times, from.shift - to.shift);
  return to.times == 1 ? product : product / to.times;
}

std::string_view name_of(Dimension dimension) {
  switch (dimension) {
    case Dimension::length:
      return "a length";
    case Dimension::angle:
      return "an angle";
    case Dimension::ratio:
      return "a ratio";
    case Dimension::pixels:
      return "a number of pixels";
    case Dimension::none:
      break;
  }
  return "a plain number";
}

std::string units_of(Dimension dimension) {
  std::string out;
  std::string_view last;
  for (const Unit& unit : kUnits) {
    const bool ascii = static_cast<unsigned char>(unit.name[0]) < 0x80;
    if (unit.dimension != dimension || !ascii) continue;
    if (!last.empty()) out += fmt::format("{}{}", out.empty() ? "" : ", ", last);
    last = unit.name;
  }
  return out.empty() ? std::string(last) : fmt::format("{} or {}", out, last);
}

}  // namespace panwright::pxn
