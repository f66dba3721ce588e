#include "sky/star_catalogue.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "base/file.h"
#include "base/source.h"
#include "base/text.h"
#include "sky/internal/star_text.h"

namespace panwright::sky {
namespace {

constexpr std::uint64_t kMostBytes = 1'000'000'000;
constexpr std::size_t kMostReported = 10;
constexpr double kMasPerYear = kDegree / 3.6e6;

enum Field : std::size_t { ra, dec, pm_ra, pm_dec, v, b_v, hip, name, kFields };
constexpr std::array<std::string_view, kFields> kColumns = {
    "ra[deg]", "dec[deg]", "pm_ra[mas/yr]", "pm_dec[mas/yr]", "v[mag]", "b_v[mag]", "hip", "name"};

std::string_view without_blanks(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

class StarReader {
 public:
  StarReader(std::string text, std::string name, DiagnosticLog& log)
      : bytes_(std::make_shared<const std::string>(std::move(text))),
        file_(log.sources().add({std::move(name), bytes_, Encoding::utf8, {}})),
        log_(log) {}

  Result<StarCatalogue> read() {
    std::string_view rest = *bytes_;
    if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
    bool header = false;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      const std::string_view line = without_blanks(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (line.empty()) continue;
      if (line.front() == '#') {
        if (!header && !read_comment(line)) return failed;
      } else if (!header) {
        if (!read_header(line)) return failed;
        header = true;
      } else {
        read_star(line);
      }
    }
    if (left_out_ > kMostReported)
      log_.report(Code("W5041"), {file_, 0, 0},
                  fmt::format("{} more left out", counted(left_out_ - kMostReported, "line")));
    if (catalogue_.stars.empty()) {
      log_.report(Code("E5040"), {file_, 0, 0}, "there is no star in it");
      return failed;
    }
    std::ranges::stable_sort(catalogue_.stars, {}, &Star::v);
    return std::move(catalogue_);
  }

 private:
  SourceSpan place(std::string_view part) const {
    const auto begin = static_cast<std::uint32_t>(part.data() - bytes_->data());
    return {file_, begin, begin + static_cast<std::uint32_t>(part.size())};
  }

  bool read_comment(std::string_view line) {
    const std::string_view text = without_blanks(line.substr(1));
    constexpr std::string_view kEpoch = "epoch ";
    if (!text.starts_with(kEpoch)) return true;
    const std::string_view word = without_blanks(text.substr(kEpoch.size()));
    const auto year = parse_double(word);
    if (!year || *year < 1000 || *year > 3000) {
      log_.report(Code("E5040"), place(word),
                  fmt::format("expected a Julian year from 1000 to 3000 as the epoch, found {}",
                              in_quotes(word)));
      return false;
    }
    catalogue_.epoch = *year;
    return true;
  }

  void split(std::string_view line) {
    parts_.clear();
    for (std::size_t at = 0; at <= line.size();) {
      const std::size_t end = std::min(line.find(',', at), line.size());
      parts_.push_back(without_blanks(line.substr(at, end - at)));
      at = end + 1;
    }
  }

  bool read_header(std::string_view line) {
    split(line);
    columns_.fill(kNone);
    count_ = parts_.size();
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const auto found = std::ranges::find(kColumns, parts_[i]);
      if (found != kColumns.end()) columns_[static_cast<std::size_t>(found - kColumns.begin())] = i;
    }
    for (const Field needed : {ra, dec, v})
      if (columns_[needed] == kNone) {
        log_.report(Code("E5040"), place(line),
                    fmt::format("the line of names has no column {}", in_quotes(kColumns[needed])),
                    "columns: ra[deg],dec[deg],pm_ra[mas/yr],pm_dec[mas/yr],v[mag],b_v[mag],hip,"
                    "name");
        return false;
      }
    return true;
  }

  std::string_view part(Field field) const {
    const std::size_t column = columns_[field];
    return column < parts_.size() ? parts_[column] : std::string_view{};
  }

  // A number in limits; an empty field is `otherwise`.
  std::optional<double> number(Field field, double low, double high, double otherwise) {
    const std::string_view text = part(field);
    if (text.empty() && std::isfinite(otherwise)) return otherwise;
    if (text.empty() && field == b_v) return otherwise;
    const auto value = parse_double(text);
    if (value && *value >= low && *value <= high) return value;
    leave_out(text, fmt::format("expected {} from {} to {}, found {}", kColumns[field], low, high,
                                in_quotes(text)));
    return std::nullopt;
  }

  // at: a part of the line; empty: the line
  void leave_out(std::string_view at, std::string message) {
    if (at.empty()) at = line_;
    if (++left_out_ <= kMostReported)
      log_.report(Code("W5041"), place(at), std::move(message) + "; the line is left out");
  }

  void read_star(std::string_view line) {
    line_ = line;
    split(line);
    if (parts_.size() != count_)
      return leave_out({}, fmt::format("expected {}, as the line of names has, found {}",
                                       counted(count_, "column"), parts_.size()));
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const auto right = number(ra, -360, 360, kNan);
    if (!right) return;
    const auto north = number(dec, -90, 90, kNan);
    if (!north) return;
    const auto east_motion = number(pm_ra, -1e5, 1e5, 0);
    if (!east_motion) return;
    const auto north_motion = number(pm_dec, -1e5, 1e5, 0);
    if (!north_motion) return;
    const auto brightness = number(v, -30, 40, kNan);
    if (!brightness) return;
    const auto colour = number(b_v, -5, 10, kNan);
    if (!colour) return;
    Star star;
    const auto [sin_ra, cos_ra] = det::sincos(*right * kDegree);
    const auto [sin_dec, cos_dec] = det::sincos(*north * kDegree);
    star.direction = {cos_dec * cos_ra, cos_dec * sin_ra, sin_dec};
    star.motion =
        kMasPerYear * (*east_motion * Vec3(-sin_ra, cos_ra, 0) +
                       *north_motion * Vec3(-sin_dec * cos_ra, -sin_dec * sin_ra, cos_dec));
    star.v = *brightness;
    star.b_v = *colour;
    const std::string_view digits = part(hip);
    std::from_chars(digits.data(), digits.data() + digits.size(), star.hip);
    star.name = part(name);
    catalogue_.stars.push_back(std::move(star));
  }

  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::shared_ptr<const std::string> bytes_;
  FileId file_;
  DiagnosticLog& log_;
  std::string_view line_;
  std::vector<std::string_view> parts_;
  std::array<std::size_t, kFields> columns_{};
  std::size_t count_ = 0;  // of all columns
  std::size_t left_out_ = 0;
  StarCatalogue catalogue_;
};

}  // namespace

Result<StarCatalogue> parse_stars(std::string text, std::string name, DiagnosticLog& log) {
  return StarReader(std::move(text), std::move(name), log).read();
}

Result<StarCatalogue> read_stars(const std::filesystem::path& path, DiagnosticLog& log) {
  auto text = read_file(path, kMostBytes, log);
  if (!text) return failed;
  return parse_stars(std::move(*text), path.string(), log);
}

std::shared_ptr<const StarCatalogue> hipparcos_stars() {
  static const auto kCatalogue = [] {
    DiagnosticLog log;
    auto stars = parse_stars(hipparcos_text(), "sky/stars.csv", log);
    assert(stars);
    return std::make_shared<const StarCatalogue>(std::move(*stars));
  }();
  return kCatalogue;
}

}  // namespace panwright::sky
