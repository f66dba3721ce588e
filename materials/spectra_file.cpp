#include "materials/spectra_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/text.h"

namespace panwright::materials {
namespace {

constexpr std::size_t kMostRows = 100'000;
constexpr double kMost = 100;  // n and k

struct SpectrumRow {
  double wavelength;
  double value;
};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

// The numbers of a line; none where it holds anything else, or more than `most`.
std::optional<std::vector<double>> numbers_of(std::string_view line, std::size_t most) {
  constexpr std::string_view kSeparators = ",; \t\r";
  std::vector<double> numbers;
  for (std::size_t at = 0;
       (at = line.find_first_not_of(kSeparators, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kSeparators, at), line.size());
    const auto number = parse_double(line.substr(at, end - at));
    if (!number || !std::isfinite(*number) || numbers.size() == most) return std::nullopt;
    numbers.push_back(*number);
    at = end;
  }
  return numbers;
}

bool begins_a_number(char c) { return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.'; }

class Reader {
 public:
  explicit Reader(TableProblem& problem) : problem_(problem) {}

  std::optional<Conductor> read(std::string_view text) {
    if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    const bool yaml = text.find("type: tabulated") != std::string_view::npos ||
                      text.find("type: formula") != std::string_view::npos;
    kind_ = yaml ? Kind::none : Kind::any;
    for (std::size_t at = 0; at < text.size() && problem_.message.empty();) {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      ++line_;
      const std::string_view line = trimmed(text.substr(at, end - at));
      if (!line.empty()) yaml ? yaml_line(line) : plain_line(line);
      at = end + 1;
    }
    line_ = 0;
    return problem_.message.empty() ? bands() : std::nullopt;
  }

 private:
  enum class Kind { none, any, nk, n, k };

  void fail(std::string message) {
    if (problem_.message.empty()) problem_ = {line_, std::move(message)};
  }

  void yaml_line(std::string_view line) {
    const std::size_t type = line.find("type:");
    if (type != std::string_view::npos && type <= 2) return begin(trimmed(line.substr(type + 5)));
    if (line.starts_with("coefficients:") && formula_ > 0) {
      const auto numbers = numbers_of(line.substr(13), 64);
      if (!numbers || numbers->size() < 3 || numbers->size() % 2 == 0)
        return fail("expected an odd number of Sellmeier coefficients, 3 or more");
      coefficients_ = *numbers;
      return;
    }
    if (line.starts_with("wavelength_range:")) {
      const auto numbers = numbers_of(line.substr(17), 2);
      if (!numbers || numbers->size() != 2) return fail("expected a wavelength range of 2 numbers");
      first_ = (*numbers)[0];
      last_ = (*numbers)[1];
      return;
    }
    if (kind_ == Kind::none) return;
    if (begins_a_number(line.front()))
      row(line);
    else if (!line.starts_with("data:") && line.front() != '#')
      kind_ = Kind::none;
  }

  void begin(std::string_view type) {
    kind_ = Kind::none;
    if (type == "tabulated nk") kind_ = Kind::nk;
    if (type == "tabulated n") kind_ = Kind::n;
    if (type == "tabulated k") kind_ = Kind::k;
    if (kind_ != Kind::none) return;
    if (type == "formula 1" || type == "formula 2")
      formula_ = type.back() - '0';
    else
      fail(fmt::format("unsupported data type {}, expected a table, formula 1 or formula 2",
                       in_quotes(type)));
  }

  void plain_line(std::string_view line) {
    const char c = line.front();
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (letter || c == '#' || c == '"' || c == '\'') return;
    row(line);
  }

  void row(std::string_view line) {
    const auto numbers = numbers_of(line, 3);
    const std::size_t count = numbers ? numbers->size() : 0;
    const bool fits =
        kind_ == Kind::any ? count == 2 || count == 3 : count == (kind_ == Kind::nk ? 3u : 2u);
    if (!fits)
      return fail(kind_ == Kind::n || kind_ == Kind::k
                      ? "expected a row of a wavelength and a value"
                  : kind_ == Kind::nk
                      ? "expected a row of a wavelength, n and k"
                      : "expected a row of a wavelength in micrometres, n and optionally k");
    if (n_.size() + k_.size() >= 2 * kMostRows)
      return fail(fmt::format("too many rows, expected at most {}", kMostRows));
    const double wavelength = (*numbers)[0];
    if (kind_ == Kind::k) return add(k_, {wavelength, (*numbers)[1]}, "k");
    add(n_, {wavelength, (*numbers)[1]}, "n");
    if (count == 3) add(k_, {wavelength, (*numbers)[2]}, "k");
  }

  void add(std::vector<SpectrumRow>& rows, const SpectrumRow& one, const char* what) {
    if (!(one.wavelength > 0))
      return fail(fmt::format("a wavelength of {} micrometres, expected above 0",
                              format_double(one.wavelength)));
    if (!rows.empty() && !(one.wavelength > rows.back().wavelength))
      return fail(fmt::format("a wavelength of {} micrometres after {}, expected a larger one",
                              format_double(one.wavelength),
                              format_double(rows.back().wavelength)));
    const bool is_n = &rows == &n_;
    if (!(one.value >= 0 && one.value <= kMost && (!is_n || one.value > 0)))
      return fail(fmt::format("{} is {}, expected {} {}", what, format_double(one.value),
                              is_n ? "above 0 and at most" : "0 to", kMost));
    rows.push_back(one);
  }

  // Whether rows reach over all bands.
  bool reaches(double first, double last, const char* what) {
    if (first <= kBands_um[2] && last >= kBands_um[0]) return true;
    fail(fmt::format("{} is given from {} to {} micrometres, expected from {} to {}{}", what,
                     format_double(first), format_double(last), kBands_um[2], kBands_um[0],
                     first > 100 ? "; the numbers look like nanometres" : ""));
    return false;
  }

  static double at(const std::vector<SpectrumRow>& rows, double wavelength) {
    const auto above =
        std::upper_bound(rows.begin() + 1, rows.end() - 1, wavelength,
                         [](double x, const SpectrumRow& one) { return x < one.wavelength; });
    const SpectrumRow& a = *(above - 1);
    const double t = (wavelength - a.wavelength) / (above->wavelength - a.wavelength);
    return a.value + t * (above->value - a.value);
  }

  double sellmeier(double wavelength) const {
    const double square = wavelength * wavelength;
    double sum = 1 + coefficients_[0];
    for (std::size_t i = 1; i + 1 < coefficients_.size(); i += 2) {
      const double c = coefficients_[i + 1];
      sum += coefficients_[i] * square / (square - (formula_ == 1 ? c * c : c));
    }
    return std::sqrt(sum);
  }

  std::optional<Conductor> bands() {
    Conductor out;
    const bool by_formula = n_.empty() && !coefficients_.empty();
    if (n_.empty() && !by_formula) {
      fail("no row of a wavelength and n found, expected at least 1");
      return std::nullopt;
    }
    if (by_formula ? last_ > 0 && !reaches(first_, last_, "n")
                   : !reaches(n_.front().wavelength, n_.back().wavelength, "n"))
      return std::nullopt;
    if (!k_.empty() && !reaches(k_.front().wavelength, k_.back().wavelength, "k"))
      return std::nullopt;
    for (int channel = 0; channel < 3; ++channel) {
      const double band = kBands_um[static_cast<std::size_t>(channel)];
      out.n[channel] = by_formula ? sellmeier(band) : at(n_, band);
      if (!k_.empty()) out.k[channel] = at(k_, band);
      if (!(out.n[channel] > 0 && out.n[channel] <= kMost)) {
        fail(fmt::format("the formula gives no valid n at {} micrometres", band));
        return std::nullopt;
      }
    }
    return out;
  }

  TableProblem& problem_;
  Kind kind_ = Kind::any;
  std::size_t line_ = 0;
  std::vector<SpectrumRow> n_;
  std::vector<SpectrumRow> k_;
  int formula_ = 0;
  std::vector<double> coefficients_;
  double first_ = 0, last_ = 0;  // of the formula
};

}  // namespace

std::optional<Conductor> read_optical_table(std::string_view text, TableProblem& problem) {
  problem = {};
  return Reader(problem).read(text);
}

}  // namespace panwright::materials
