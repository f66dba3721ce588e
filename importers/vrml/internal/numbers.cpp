#include "importers/vrml/internal/numbers.h"

#include <charconv>
#include <system_error>

namespace panwright::importers::vrml {

NumberKind read_hard_number(const char* begin, const char* end, std::int64_t exponent,
                            double& out) {
  if (std::from_chars(begin, end, out).ec != std::errc::result_out_of_range)
    return NumberKind::good;
  // from_chars does not tell too large from too small: the power of ten of the first digit does
  std::int64_t before_point = 0;
  for (const char* c = begin; c < end && is_digit(*c); ++c) ++before_point;
  std::int64_t place = before_point;
  bool zero = true;
  for (const char* c = begin; c < end && (*c | 0x20) != 'e'; ++c) {
    if (*c == '.') continue;
    --place;
    if (*c == '0') continue;
    zero = false;
    break;
  }
  if (!zero && place + exponent > 0) return NumberKind::too_large;
  out = 0;
  return NumberKind::good;
}

NumberKind read_hexadecimal(const char*& p, std::int32_t& out) {
  const char* at = p;
  const bool negative = *at == '-';
  if (negative || *at == '+') ++at;
  at += 2;
  const char* const begin = at;
  std::uint64_t bits = 0;
  for (;; ++at) {
    const char lower = static_cast<char>(*at | 0x20);
    unsigned digit = 0;
    if (is_digit(*at))
      digit = static_cast<unsigned>(*at - '0');
    else if (lower >= 'a' && lower <= 'f')
      digit = static_cast<unsigned>(lower - 'a') + 10;
    else
      break;
    if (bits <= 0xffffffffu) bits = bits * 16 + digit;
  }
  if (at == begin) return NumberKind::none;
  p = at;
  if (bits > 0xffffffffu) return NumberKind::too_large;
  const auto value = static_cast<std::uint32_t>(bits);
  out = static_cast<std::int32_t>(negative ? 0u - value : value);
  return NumberKind::good;
}

}  // namespace panwright::importers::vrml
