#include "compiler/size.h"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

namespace panwright::compiler {

namespace {

struct LengthUnit {
  double metres;
  std::string_view name;
};
constexpr LengthUnit kLengthUnits[] = {
    {1e3, "km"}, {1, "m"}, {1e-3, "mm"}, {1e-6, "µm"}, {1e-9, "nm"}};

// The largest in which a length is at least 1 as it is written.
const LengthUnit& unit_for(double metres) {
  constexpr double kRounded = 0.9995;  // to three digits
  for (const LengthUnit& unit : kLengthUnits)
    if (metres >= kRounded * unit.metres) return unit;
  return metres > 0 ? *(std::end(kLengthUnits) - 1) : kLengthUnits[1];
}

// To three digits, without an exponent up to a million.
std::string number(double x) {
  return x >= 1000 && x < 1e6 ? fmt::format("{:.0f}", x) : fmt::format("{:.3g}", x);
}

// Typical lengths of things that everybody has seen.
std::string_view thing_of(double metres) {
  constexpr struct {
    double below;
    std::string_view name;
  } kThings[] = {{1e-3, "smaller than a grain of sand"},
                 {0.012, "about a pea"},
                 {0.05, "about a coin"},
                 {0.13, "about a coffee cup"},
                 {0.6, "about a shoe box"},
                 {1.3, "about a washing machine"},
                 {3, "about a table"},
                 {6, "about a car"},
                 {16, "about a bus"},
                 {35, "about a house"},
                 {90, "about an airliner"},
                 {200, "about a football field"},
                 {1e5, "larger than any spacecraft"}};
  for (const auto& thing : kThings)
    if (metres < thing.below) return thing.name;
  return "the size of a celestial body";
}

}  // namespace

std::string length_in_words(double metres) {
  const LengthUnit& unit = unit_for(metres);
  return fmt::format("{} {}", number(metres / unit.metres), unit.name);
}

std::string size_in_words(const Vec3& extents) {
  const double largest = std::max({extents.x, extents.y, extents.z});
  const LengthUnit& unit = unit_for(largest);
  // what is left of roundings is 0
  const auto shown = [&](double x) { return number(x < 1e-6 * largest ? 0 : x / unit.metres); };
  return fmt::format("{} x {} x {} {} ({})", shown(extents.x), shown(extents.y), shown(extents.z),
                     unit.name, thing_of(largest));
}

}  // namespace panwright::compiler
