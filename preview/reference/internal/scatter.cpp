#include "preview/reference/internal/scatter.h"

#include <algorithm>
#include <cmath>

namespace panwright::preview::reference {
namespace {

// ten angular radii of the Sun: lobes this wide are even over its disc to a percent
constexpr double kNarrowSlope = 0.05;
// what roughness maps leave of a slope; a fiftieth of what the Sun's disc blurs
constexpr double kLeastSlope = 1e-4;

}  // namespace

Scatter::Scatter(const materials::Material& material)
    : Scatter(
          materials::Scattering(material),
          std::min(1.0,
                   materials::narrowest_slope(material, materials::Lobes::finite).value_or(1))) {}

bool Scatter::is_narrow() const { return slope < kNarrowSlope; }

Scatter Scatter::roughened(double factor) const {
  const double limited = std::max({factor, std::min(1.0, kLeastSlope / slope), 0.0});
  return {scattering.scaled(limited), slope * limited};
}

Scatter Scatter::reflecting(const Vec3& reflectance) const {
  return {scattering.reflecting(reflectance), slope};
}

}  // namespace panwright::preview::reference
