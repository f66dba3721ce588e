#include "scenario/internal/input.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/file.h"
#include "base/text.h"

namespace panwright::scenario {

Result<Text> read_text(const std::filesystem::path& path, DiagnosticLog& log) {
  auto bytes = read_file(path, kMaxTextBytes, log);
  if (!bytes) return failed;
  return memory_text(path.string(), std::move(*bytes));
}

Text memory_text(std::string name, std::string bytes) {
  return {std::move(name), SharedText(std::make_shared<const std::string>(std::move(bytes)))};
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank_char(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank_char(text.back())) text.remove_suffix(1);
  return text;
}

void split_words(std::string_view text, std::vector<std::string_view>& words) {
  words.clear();
  std::size_t at = 0;
  while (at < text.size()) {
    while (at < text.size() && is_blank_char(text[at])) ++at;
    const std::size_t begin = at;
    while (at < text.size() && !is_blank_char(text[at])) ++at;
    if (at > begin) words.push_back(text.substr(begin, at - begin));
  }
}

Input::Input(const Text& text, DiagnosticLog& log)
    : name_(text.name),
      bytes_(text.bytes ? text.bytes : memory_text({}, {}).bytes),
      log_(log),
      file_(log.sources().add({text.name, bytes_, Encoding::utf8, {}})) {
  if (bytes_->starts_with("\xef\xbb\xbf")) at_ = 3;
}

Input::~Input() {
  if (scaled_ > 1)
    log_.report(Code("W8006"), {file_, 0, 0},
                fmt::format("{} more in this file", counted(scaled_ - 1, "quaternion")));
}

void Input::report_scaled(double length, std::string_view at) {
  if (++scaled_ == 1)
    report(Code("W8006"), at,
           fmt::format("the quaternion has length {:.6g} and is scaled to 1", length));
}

bool Input::next_line(std::string_view& line) {
  const std::string_view text = *bytes_;
  if (at_ >= text.size() || errors_ >= kMostErrors) return false;
  const std::size_t end = std::min(text.find_first_of("\r\n", at_), text.size());
  line = text.substr(at_, end - at_);
  at_ = end + 1;
  if (end + 1 < text.size() && text[end] == '\r' && text[end + 1] == '\n') ++at_;
  return true;
}

SourceSpan Input::span(std::string_view part) const {
  const std::string_view text = *bytes_;
  const std::less<> before;
  if (part.data() == nullptr || before(part.data(), text.data()) ||
      before(text.data() + text.size(), part.data()))
    return {file_, 0, 0};
  const auto begin = static_cast<std::uint32_t>(part.data() - text.data());
  return {file_, begin, begin + static_cast<std::uint32_t>(part.size())};
}

void Input::error(Code code, std::string_view at, std::string message, std::string hint) {
  ++errors_;
  report(code, at, std::move(message), std::move(hint));
  if (errors_ == kMostErrors)
    log_.report(Code("E8001"), span(at), fmt::format("reading ends after {} errors", errors_));
}

void Input::report(Code code, std::string_view at, std::string message, std::string hint) {
  log_.report(code, span(at), std::move(message), std::move(hint));
}

void Input::deviation(bool strict, std::string_view at, std::string message, std::string hint) {
  if (strict)
    error(Code("E8001"), at, std::move(message), std::move(hint));
  else
    report(Code("W8012"), at, std::move(message), std::move(hint));
}

std::optional<double> Input::number(std::string_view word, std::string_view what) {
  std::optional<double> value = parse_double(word);
  if (!value) {
    std::string other(word);
    std::ranges::replace_if(
        other, [](char c) { return c == 'D' || c == 'd'; }, 'e');
    value = parse_double(other);
  }
  if (!value)
    error(Code("E8001"), word,
          fmt::format("expected a number for {}, found {}", what, in_quotes(word)));
  return value;
}

std::optional<Quat> unit_quaternion(const Quat& q, Input& input, std::string_view at) {
  constexpr double kPrinted = 1e-4;
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(length >= 0.5 && length <= 2)) {
    input.error(Code("E8005"), at,
                std::isfinite(length)
                    ? fmt::format("the quaternion has length {:.6g}, expected 1", length)
                    : std::string("the quaternion is not finite"));
    return std::nullopt;
  }
  if (std::abs(length - 1) > kPrinted) input.report_scaled(length, at);
  return Quat(q.w / length, q.x / length, q.y / length, q.z / length);
}

}  // namespace panwright::scenario
