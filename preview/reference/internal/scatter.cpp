#include "preview/reference/internal/scatter.h"

#include <algorithm>
#include <cmath>

namespace panwright::preview::reference {
namespace {

// ten angular radii of the Sun: lobes this wide are even over its disc to a percent
constexpr double kNarrowSlope = 0.05;
// what roughness maps leave of a slope; a fiftieth of what the Sun's disc blurs
constexpr double kLeastSlope = 1e-4;

double least_slope(const materials::Material& material) {
  using materials::SpecularLaw;
  double slope = 1;
  switch (material.specular_law) {
    case SpecularLaw::none:
      break;
    case SpecularLaw::mirror:
      // below a rough coat, which blurs it
      if (material.coat) slope = (material.coat->index - 1) * std::sqrt(0.5) * material.coat->alpha;
      break;
    case SpecularLaw::blinn_phong:
      slope = std::sqrt(2 / (material.shine + 2));
      break;
    case SpecularLaw::cook_torrance:
      slope = material.cook[1];
      break;
    case SpecularLaw::beckmann:
    case SpecularLaw::ggx:
      slope = std::min(material.cook[1], material.alpha_y);
      break;
  }
  if (material.coat && material.coat->alpha > 0) slope = std::min(slope, material.coat->alpha);
  return slope;
}

}  // namespace

Scatter::Scatter(const materials::Material& material)
    : Scatter(materials::Scattering(material), least_slope(material)) {}

bool Scatter::is_narrow() const { return slope < kNarrowSlope; }

Scatter Scatter::roughened(double factor) const {
  const double limited = std::max({factor, std::min(1.0, kLeastSlope / slope), 0.0});
  return {scattering.scaled(limited), slope * limited};
}

Scatter Scatter::reflecting(const Vec3& reflectance) const {
  return {scattering.reflecting(reflectance), slope};
}

}  // namespace panwright::preview::reference
