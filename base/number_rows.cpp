#include "base/number_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "base/file.h"
#include "base/text.h"

namespace panwright {

namespace {

constexpr std::uint64_t kMostRowBytes = std::uint64_t{1} << 30;
constexpr std::size_t kMostRows = 10'000'000;

bool is_row_separator(char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r'; }

}  // namespace

std::optional<std::vector<double>> numbers_in(std::string_view line) {
  std::vector<double> out;
  for (std::size_t at = 0; at < line.size();) {
    if (is_row_separator(line[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < line.size() && !is_row_separator(line[end])) ++end;
    const auto number = parse_double(line.substr(at, end - at));
    if (!number || !std::isfinite(*number)) return std::nullopt;
    out.push_back(*number);
    at = end;
  }
  return out;
}

Result<std::vector<double>> read_number_rows(const std::filesystem::path& path, std::size_t columns,
                                             Code code, DiagnosticLog& log) {
  auto text = read_file(path, kMostRowBytes, log);
  if (!text) return failed;
  const auto held = std::make_shared<const std::string>(*std::move(text));
  SourceFile source;
  source.name = path.string();
  source.bytes = held;
  const FileId file = log.sources().add(std::move(source));
  const std::string_view all = *held;
  std::vector<double> rows;
  bool first = true;
  for (std::size_t at = 0; at < all.size();) {
    const std::size_t end = std::min(all.find('\n', at), all.size());
    const SourceSpan where{file, static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(end)};
    std::string_view line = all.substr(at, end - at);
    line = line.substr(0, line.find('#'));
    at = end + 1;
    const auto numbers = numbers_in(line);
    if (numbers && numbers->empty()) continue;
    const bool heading = first && !numbers;
    first = false;
    if (heading) continue;
    if (!numbers || numbers->size() < columns) {
      const std::string found =
          numbers ? fmt::format("{}", numbers->size()) : in_quotes(line.substr(0, 60));
      log.report(
          code, where,
          fmt::format("expected {} in each line, found {}", counted(columns, "number"), found));
      return failed;
    }
    if (rows.size() / columns >= kMostRows) {
      log.report(code, where, fmt::format("more than {} lines of numbers", kMostRows));
      return failed;
    }
    rows.insert(rows.end(), numbers->begin(),
                numbers->begin() + static_cast<std::ptrdiff_t>(columns));
  }
  return rows;
}

}  // namespace panwright
