#include "preview/frame/sun_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace panwright::preview {

double light_within(double radius, double limb_darkening) {
  const double square = radius * radius;
  // ∫ (1 − u + u·sqrt(1 − r²)) 2 r dr; 1 − (1 − r²)^(3/2) without cancellation
  const double cosine = std::sqrt(std::max(1 - square, 0.0));
  const double darkened = square * (1 + cosine + cosine * cosine) / (1 + cosine);
  return ((1 - limb_darkening) * square + limb_darkening * (2.0 / 3.0) * darkened) /
         (1 - limb_darkening / 3);
}

// measured (tests/preview/sun_points_test.cpp): kError · points^-3/4
constexpr double kError = 0.305;

double error_of_sun_points(unsigned points) {
  return points > 1 ? kError / std::pow(points, 0.75) : 0;
}

unsigned sun_points_for(double error) {
  const double eights = std::ceil(std::pow(kError / error, 4.0 / 3.0) / 8);
  return 8 * static_cast<unsigned>(std::clamp(eights, 1.0, kMostSunPoints / 8.0));
}

void find_sun_points(const SunDisc& disc, unsigned points, std::vector<Vec2>& places) {
  places.assign(1, Vec2(0));
  if (points <= 1) return;
  places.clear();
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (unsigned i = 0; i < points; ++i) {
    const double share = (i + 0.5) / points;
    double low = 0;
    double high = 1;
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      (light_within(middle, disc.limb_darkening) < share ? low : high) = middle;
    }
    const double radius = disc.tangent * 0.5 * (low + high);
    places.emplace_back(radius * std::cos(golden * i), radius * std::sin(golden * i));
  }
}

}  // namespace panwright::preview
