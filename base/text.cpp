#include "base/text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace panwright {

namespace {

// The power of ten of the first digit that is not 0, in a number that from_chars has accepted.
// from_chars reports underflow as it does overflow; the sign of this tells them apart.
long decimal_exponent(std::string_view number) {
  long exponent = 0;
  if (const std::size_t e = number.find_first_of("eE"); e != std::string_view::npos) {
    std::string_view digits = number.substr(e + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
    if (error == std::errc::result_out_of_range)
      exponent = (digits[0] == '-' ? -1 : 1) * (std::numeric_limits<long>::max() / 2);
    number = number.substr(0, e);
  }
  if (number.starts_with('-')) number.remove_prefix(1);
  const auto point = static_cast<long>(std::min(number.find('.'), number.size()));
  const auto first = static_cast<long>(std::min(number.find_first_of("123456789"), number.size()));
  return exponent + point - first - (first < point ? 1 : 0);
}

}  // namespace

std::optional<double> parse_double(std::string_view text) {
  // from_chars takes no plus sign, and accepts words such as inf and nan
  std::string_view digits = text;
  if (!digits.empty() && digits[0] == '+') {
    digits.remove_prefix(1);
    if (!digits.empty() && digits[0] == '-') return std::nullopt;
  }
  for (const char c : digits)
    if (!((c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.' || c == 'e' || c == 'E'))
      return std::nullopt;
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size() || digits.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    if (decimal_exponent(digits) < 0) return digits[0] == '-' ? -0.0 : 0.0;
    return std::nullopt;
  }
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string format_double(double value) { return fmt::format("{}", value); }

std::string counted(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string markup_escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string out = "'";
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (i >= kLongest && (static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) return out + "…'";
    const auto c = static_cast<unsigned char>(text[i]);
    if (c == '\n')
      out += "\\n";
    else if (c == '\t')
      out += "\\t";
    else if (c < 0x20 || c == 0x7f)
      out += fmt::format("\\x{:02x}", c);
    else
      out.push_back(text[i]);
  }
  return out + "'";
}

bool starts_with_any(std::string_view text, std::initializer_list<std::string_view> marks) {
  for (const std::string_view mark : marks)
    if (text.starts_with(mark)) return true;
  return false;
}

}  // namespace panwright
