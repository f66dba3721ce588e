#include "base/text.h"

#include <fmt/format.h>

#include <cmath>

namespace panwright {

std::optional<double> parse_double(std::string_view text) {
  // from_chars takes no plus sign, and takes words that are no decimal numbers
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
    // note: from_chars reports underflow the same way; a negative exponent tells them apart
    const std::size_t exponent = digits.find_first_of("eE");
    const bool tiny = exponent == std::string_view::npos
                          ? digits.find('.') != std::string_view::npos
                          : exponent + 1 < digits.size() && digits[exponent + 1] == '-';
    if (tiny) return digits[0] == '-' ? -0.0 : 0.0;
    return std::nullopt;
  }
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string format_double(double value) { return fmt::format("{}", value); }

std::string counted(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
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

}  // namespace panwright
