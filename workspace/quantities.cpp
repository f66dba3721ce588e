#include "workspace/quantities.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

#include "base/math.h"
#include "base/text.h"

namespace panwright::workspace {

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  constexpr const char* kSeparators = " \t\n\r,";
  for (std::size_t at = text.find_first_not_of(kSeparators); at != text.npos;) {
    const std::size_t end = std::min(text.find_first_of(kSeparators, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(kSeparators, end);
  }
  return words;
}

std::optional<std::vector<double>> parse_numbers(std::string_view text, std::size_t count) {
  std::vector<double> numbers;
  for (const std::string_view word : words_of(text)) {
    const auto value = parse_double(word);
    if (!value) return std::nullopt;
    numbers.push_back(*value);
  }
  if (numbers.size() != count) return std::nullopt;
  return numbers;
}

std::optional<double> parse_angle(std::string_view text) {
  constexpr std::pair<std::string_view, double> kUnits[] = {
      {"deg", kDegree}, {"mrad", 1e-3},           {"urad", 1e-6},
      {"rad", 1.0},     {"arcmin", kDegree / 60}, {"arcsec", kDegree / 3600}};
  std::string_view number = text;
  double unit = kDegree;
  for (const auto& [name, size] : kUnits) {
    if (!number.ends_with(name)) continue;
    number.remove_suffix(name.size());
    unit = size;
    break;
  }
  const auto value = parse_double(number);
  if (!value) return std::nullopt;
  return *value * unit;
}

std::optional<double> parse_length(std::string_view text) {
  constexpr std::pair<std::string_view, double> kUnits[] = {
      {"mm", 1e-3}, {"cm", 1e-2}, {"dm", 0.1},    {"km", 1e3},
      {"um", 1e-6}, {"m", 1},     {"in", 0.0254}, {"ft", 0.3048}};
  double unit = 1;
  for (const auto& [name, size] : kUnits) {
    if (!text.ends_with(name)) continue;
    text.remove_suffix(name.size());
    unit = size;
    break;
  }
  const auto value = parse_double(text);
  if (!value) return std::nullopt;
  return *value * unit;
}

std::optional<double> parse_time(std::string_view text) {
  constexpr std::pair<std::string_view, double> kUnits[] = {{"ms", 1e-3}, {"us", 1e-6}, {"s", 1}};
  double unit = 1;
  for (const auto& [name, size] : kUnits) {
    if (!text.ends_with(name)) continue;
    text.remove_suffix(name.size());
    unit = size;
    break;
  }
  const auto value = parse_double(text);
  if (!value) return std::nullopt;
  return *value * unit;
}

std::optional<double> parse_share(std::string_view text) {
  const bool percent = text.ends_with('%');
  if (percent) text.remove_suffix(1);
  const auto number = parse_numbers(text, 1);
  if (!number) return std::nullopt;
  return percent ? (*number)[0] / 100 : (*number)[0];
}

std::optional<std::uint64_t> parse_bytes(std::string_view text) {
  constexpr std::string_view kUnits = "kmgtpe";
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  std::string_view rest = lower;
  if (rest.ends_with("ib"))
    rest.remove_suffix(2);
  else if (rest.ends_with('b'))
    rest.remove_suffix(1);
  double unit = 1;
  if (!rest.empty())
    if (const std::size_t power = kUnits.find(rest.back()); power != kUnits.npos) {
      unit = std::exp2(10.0 * static_cast<double>(power + 1));
      rest.remove_suffix(1);
    }
  while (rest.ends_with(' ')) rest.remove_suffix(1);
  const auto number = parse_double(rest);
  const double bytes = number ? *number * unit : -1;
  if (!(bytes >= 0 && bytes < 0x1p63)) return std::nullopt;
  return static_cast<std::uint64_t>(bytes);
}

std::optional<ImageSize> image_size(std::string_view size) {
  constexpr std::uint32_t kMaxSide = 16384;
  const std::size_t cross = size.find_first_of("xX, ");
  const auto side = [&](std::string_view digits) -> std::uint32_t {
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const bool whole = error == std::errc() && end == digits.data() + digits.size();
    return whole && value <= kMaxSide ? value : 0;
  };
  const std::uint32_t width = side(size.substr(0, std::min(cross, size.size())));
  const std::size_t second = cross == size.npos ? cross : size.find_first_not_of(", ", cross + 1);
  const std::uint32_t height =
      cross == size.npos ? width : side(second == size.npos ? "" : size.substr(second));
  if (width == 0 || height == 0) return std::nullopt;
  return ImageSize{width, height};
}

}  // namespace panwright::workspace
