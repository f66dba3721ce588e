#include "workspace/exposure.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/math.h"

namespace panwright::workspace {

double stops_of_sun(const world::World& world) {
  const std::optional<Vec3>& irradiance = world.sun().irradiance;
  if (!irradiance) return 0;
  const double sun = max_component(*irradiance);
  const double strongest = sun > 0 ? sun : max_component(world.white());
  return strongest > 0 ? std::log2(strongest) : 0;
}

double auto_exposure(const image::Image& image, double stops_of_sun) {
  constexpr double kShare = 0.99;  // of the lit pixels, that stay below
  constexpr double kBright = 0.8;  // of white, linear
  constexpr double kSteps = 8;     // of a stop: neighbouring images differ by none or a visible one
  // a sky stands behind the targets: it is lit too
  bool sky = false;
  for (std::size_t i = 0; !sky && i < image.coverage.size(); ++i)
    sky = image.coverage[i] == 0 && image.radiance[3 * i + 1] > 0;
  std::vector<float> lit;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float* rgb = &image.radiance[3 * i];
    const float largest = std::max({rgb[0], rgb[1], rgb[2]});
    const float share = sky || image.coverage.empty() ? 1.0f : image.coverage[i];
    if (largest > 0 && share > 0 && std::isfinite(largest)) lit.push_back(largest / share);
  }
  if (lit.empty()) return 0;
  const auto at =
      lit.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(lit.size() - 1));
  std::nth_element(lit.begin(), at, lit.end());
  // a PNG shows π L 2^EV
  const double stops = det::log(kBright / (kPi * static_cast<double>(*at))) / det::log(2.0);
  return std::round(kSteps * (stops + stops_of_sun)) / kSteps;
}

}  // namespace panwright::workspace
