#include "workspace/budget.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/text.h"
#include "workspace/quantities.h"

namespace panwright::workspace {
namespace {

const std::vector<std::string_view> kTerms = {"tolerance", "nearest",  "ifov",     "pixels",
                                              "flux",      "centroid", "approach", "corridor"};

std::optional<double> pixels_of(std::string_view text) {
  if (text.ends_with("px")) text.remove_suffix(2);
  const auto number = parse_numbers(text, 1);
  if (!number) return std::nullopt;
  return (*number)[0];
}

class BudgetReader {
 public:
  explicit BudgetReader(DiagnosticLog& log) : log_(log) {}

  Result<scene::Budget> read(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find_first_of(" ,\t", at), text.size());
      if (end > at && !term(text.substr(at, end - at))) return failed;
      at = end + 1;
    }
    scene::Budget& b = budget_;
    if (!b.tolerance && !b.nearest && !b.flux)
      return fail("no requirement is given, expected nearest=, tolerance= or flux=, or none");
    if (b.nearest.has_value() != b.ifov.has_value())
      return fail("nearest and ifov require each other");
    if (!b.nearest && (b.pixels || b.centroid || !b.approach.empty()))
      return fail("pixels, centroid and approach need nearest and ifov");
    if (given_.contains("corridor") && b.approach.empty())
      return fail("corridor needs an approach");
    if (b.nearest && !b.pixels) b.pixels = scene::Budget::kDefaultPixels;
    return budget_;
  }

 private:
  Failed fail(const std::string& problem, const std::string& hint = {}) {
    log_.report(Code("E0201"), {}, "--budget: " + problem,
                hint.empty() ? "as in --budget \"nearest=5km ifov=0.1mrad flux=0.1%\"" : hint);
    return failed;
  }

  bool number(std::string_view name, std::string_view value, std::optional<double>& to,
              std::optional<double> (*parse)(std::string_view), double most,
              std::string_view expected) {
    to = parse(value);
    if (to && *to > 0 && *to <= most) return true;
    fail(fmt::format("{} is {}, expected {}", name, in_quotes(value), expected));
    return false;
  }

  bool term(std::string_view word) {
    const std::size_t sign = word.find('=');
    const std::string_view name = word.substr(0, sign);
    if (sign == word.npos || std::ranges::find(kTerms, name) == kTerms.end()) {
      const auto near = nearest_name(name, kTerms);
      fail(fmt::format("{} is not a term", in_quotes(word)),
           near ? fmt::format("did you mean '{}='?", *near)
                : "terms are tolerance, nearest, ifov, pixels, flux, centroid, approach, corridor");
      return false;
    }
    if (!given_.insert(std::string(name)).second) {
      fail(fmt::format("{} is given twice", name));
      return false;
    }
    const std::string_view value = word.substr(sign + 1);
    constexpr std::string_view kLength = "a length above 0, as 5km";
    constexpr std::string_view kPixels = "a number of pixels above 0, as 0.25px";
    if (name == "tolerance")
      return number(name, value, budget_.tolerance, parse_length, 1e30, kLength);
    if (name == "nearest") return number(name, value, budget_.nearest, parse_length, 1e30, kLength);
    if (name == "ifov")
      return number(name, value, budget_.ifov, parse_angle, 1, "an angle above 0, as 0.2mrad");
    if (name == "pixels") return number(name, value, budget_.pixels, pixels_of, 1e6, kPixels);
    if (name == "centroid") return number(name, value, budget_.centroid, pixels_of, 1e6, kPixels);
    if (name == "flux")
      return number(name, value, budget_.flux, parse_share, 1, "a share above 0, as 0.1%");
    if (name == "corridor") {
      std::optional<double> angle;
      if (!number(name, value, angle, parse_angle, kPi, "an angle above 0, as 30deg")) return false;
      budget_.corridor = *angle;
      return true;
    }
    budget_.approach = value;
    if (!value.empty()) return true;
    fail("approach is empty, expected a frame");
    return false;
  }

  DiagnosticLog& log_;
  scene::Budget budget_;
  std::set<std::string> given_;
};

}  // namespace

Result<scene::Budget> budget_of_text(std::string_view text, DiagnosticLog& log) {
  if (text == "none") return scene::Budget{};
  return BudgetReader(log).read(text);
}

}  // namespace panwright::workspace
