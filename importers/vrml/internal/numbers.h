// Fast and correctly rounded numbers of a NUL-terminated text.
#pragma once

#include <cstdint>

namespace panwright::importers::vrml {

enum class NumberKind : std::uint8_t { none, good, too_large };

inline bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

// Reads a number without its sign that needs the slow path: [begin, end), exponent as written.
NumberKind read_hard_number(const char* begin, const char* end, std::int64_t exponent, double& out);

// Reads a decimal number, "+1", ".5" and "5." included, and moves p past it. Underflow gives 0 or
// the nearest number below the normal ones. If the digits fit into 53 bits and the power of ten is
// exact, one rounding suffices (W. Clinger, "How to read floating point numbers accurately", 1990).
inline NumberKind read_number(const char*& p, double& out) {
  static constexpr double kTen[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                    1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                    1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const char* at = p;
  const bool negative = *at == '-';
  if (negative || *at == '+') ++at;
  const char* const begin = at;
  std::uint64_t digits = 0;
  for (; is_digit(*at); ++at) digits = digits * 10 + static_cast<unsigned char>(*at - '0');
  std::int64_t count = at - begin;
  std::int64_t power = 0;
  if (*at == '.') {
    const char* const fraction = ++at;
    for (; is_digit(*at); ++at) digits = digits * 10 + static_cast<unsigned char>(*at - '0');
    power = fraction - at;
    count -= power;
  }
  if (count == 0) return NumberKind::none;
  std::int64_t exponent = 0;
  if ((*at | 0x20) == 'e') {
    const char* mark = at + 1;
    const bool down = *mark == '-';
    if (down || *mark == '+') ++mark;
    if (is_digit(*mark)) {
      for (; is_digit(*mark); ++mark)
        if (exponent < 1'000'000'000'000) exponent = exponent * 10 + (*mark - '0');
      if (down) exponent = -exponent;
      power += exponent;
      at = mark;
    }
  }
  p = at;
  if (count <= 19 && digits <= (std::uint64_t{1} << 53) && power >= -22 && power <= 22) {
    const auto exact = static_cast<double>(digits);
    out = power < 0 ? exact / kTen[-power] : exact * kTen[power];
  } else {
    const NumberKind kind = read_hard_number(begin, at, exponent, out);
    if (kind != NumberKind::good) return kind;
  }
  if (negative) out = -out;
  return NumberKind::good;
}

// Reads an integer, decimal or "0x…" (as 32 bits), and moves p past it. Decimals that continue as
// 1.5 or 1e3 are refused.
NumberKind read_hexadecimal(const char*& p, std::int32_t& out);
inline NumberKind read_integer(const char*& p, std::int32_t& out) {
  const char* at = p;
  const bool negative = *at == '-';
  if (negative || *at == '+') ++at;
  if (*at == '0' && (at[1] | 0x20) == 'x') return read_hexadecimal(p, out);
  const char* const begin = at;
  std::uint64_t value = 0;
  for (; is_digit(*at); ++at)
    if (value <= 0xffffffffu) value = value * 10 + static_cast<unsigned char>(*at - '0');
  if (at == begin || *at == '.' || (*at | 0x20) == 'e') return NumberKind::none;
  p = at;
  if (value > (negative ? 0x80000000u : 0xffffffffu)) return NumberKind::too_large;
  const auto bits = static_cast<std::uint32_t>(value);
  out = static_cast<std::int32_t>(negative ? 0u - bits : bits);
  return NumberKind::good;
}

}  // namespace panwright::importers::vrml
