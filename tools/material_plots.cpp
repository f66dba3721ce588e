#include "tools/material_plots.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "base/text.h"
#include "materials/brdf.h"
#include "materials/energy.h"
#include "tools/plot.h"

namespace panwright::tools {
namespace {

using Points = Plot::Points;

constexpr const char* kChannels[] = {"650 nm", "550 nm", "450 nm"};
constexpr const char* kChannelColors[] = {"#c0392b", "#27ae60", "#2c6fbb"};

}  // namespace

std::string albedo_plot(const materials::Material& material) {
  Plot plot(material.name + ": directional albedo", "angle from the normal, degrees", "albedo", 0,
            90, 0, 1);
  for (int x = 0; x <= 90; x += 15) plot.x_tick(x, std::to_string(x));
  for (int y = 0; y <= 10; y += 2) plot.y_tick(y / 10.0, fmt::format("{:.1f}", y / 10.0));
  std::array<Points, 3> curves;
  for (const int angle :
       {0, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 75, 80, 83, 86, 88}) {
    const Vec3 albedo = materials::directional_albedo(material, det::cos(angle * kDegree));
    for (std::size_t k = 0; k < 3; ++k) curves[k].emplace_back(angle, albedo[static_cast<int>(k)]);
  }
  for (std::size_t k = 0; k < 3; ++k) plot.curve(curves[k], kChannelColors[k], kChannels[k]);
  return plot.finish();
}

std::string slices_plot(const materials::Material& material) {
  constexpr int kLights_deg[] = {0, 30, 60, 80};
  constexpr const char* kColors[] = {"#222222", "#2c6fbb", "#27ae60", "#c0392b"};
  const materials::ShadingContext local{Vec3(1, 0, 0), materials::kSunAlpha2};
  const auto direction = [](double angle) {
    const auto t = det::sincos(angle * kDegree);
    return Vec3(t.sin, 0, t.cos);
  };
  std::array<Points, 4> curves;
  double peak = 1e-30;
  for (std::size_t i = 0; i < 4; ++i)
    // note: half a degree apart, and finely about the mirrored direction and the light
    for (int step = -1780; step <= 1780; ++step) {
      const double angle = step * 0.05;
      const double glint =
          std::min(std::fabs(angle - kLights_deg[i]), std::fabs(angle + kLights_deg[i]));
      if (step % 10 != 0 && glint > 3) continue;
      const Vec3 f = materials::f64::brdf(material, direction(-kLights_deg[i]), direction(angle),
                                          Vec3(0, 0, 1), Vec3(1), local);
      const double value = kPi * (f.x + f.y + f.z) / 3;
      peak = std::max(peak, value);
      curves[i].emplace_back(angle, value);
    }
  const double top = std::ceil(det::log10(peak));
  const double bottom = std::max(top - 6, -4.0) < top - 2 ? std::max(top - 6, -4.0) : top - 2;
  Plot plot(material.name + ": reflectance in the plane of incidence",
            "viewing angle, degrees (light from the left, its mirror image to the right)", "π f",
            -90, 90, bottom, top);
  for (int x = -90; x <= 90; x += 30) plot.x_tick(x, std::to_string(x));
  for (double y = bottom; y <= top; y += 1) plot.y_tick(y, fmt::format("1e{:.0f}", y));
  for (std::size_t i = 0; i < 4; ++i) {
    for (auto& [x, y] : curves[i]) y = y > 0 ? det::log10(y) : bottom;
    plot.curve(curves[i], kColors[i], fmt::format("light {}°", kLights_deg[i]));
  }
  return plot.finish();
}

std::string fit_plot(const std::vector<materials::Reading>& readings, const materials::Fit& fit,
                     const std::string& name, int band) {
  constexpr const char* kColors[] = {"#222222", "#2c6fbb", "#27ae60", "#c0392b"};
  // viewing angles are positive on the far side of the normal from the light
  struct Slice {
    int light_deg;
    Points measured;
  };
  std::vector<Slice> slices;
  double least = 1, most = 1e-6;
  for (const materials::Reading& r : readings) {
    if (std::fabs(r.to_light.x * r.to_viewer.y - r.to_light.y * r.to_viewer.x) > 1e-6) continue;
    const int light = static_cast<int>(std::lround(det::acos(r.to_light.z) / kDegree));
    auto at = std::find_if(slices.begin(), slices.end(),
                           [&](const Slice& s) { return s.light_deg == light; });
    if (at == slices.end()) {
      if (slices.size() == std::size(kColors)) continue;
      at = slices.insert(slices.end(), {light, {}});
    }
    const double side = r.to_light.x * r.to_viewer.x + r.to_light.y * r.to_viewer.y;
    const double angle = det::acos(std::clamp(r.to_viewer.z, -1.0, 1.0)) / kDegree;
    const double reflectance = band < 0 ? r.reflectance : r.rgb[band];
    at->measured.emplace_back(side > 0 ? -angle : angle, det::log10(std::max(reflectance, 1e-4)));
    least = std::min(least, std::max(reflectance, 1e-4));
    most = std::max(most, reflectance);
  }
  const double bottom = std::floor(det::log10(least));
  const double top = std::max(std::ceil(det::log10(most)), bottom + 1);
  constexpr const char* kBands[] = {" in red", " in green", " in blue"};
  Plot plot(fmt::format("{}{}: readings, and {} ({:.3f} decades RMS)", name,
                        band < 0 ? "" : kBands[band], fit.brdf, fit.rms_decades),
            "viewing angle, degrees (light from the left)", "f, 1/sr", -90, 90, bottom, top);
  for (int x = -90; x <= 90; x += 30) plot.x_tick(x, std::to_string(x));
  for (double y = bottom; y <= top; y += 1) plot.y_tick(y, fmt::format("1e{:.0f}", y));
  for (std::size_t i = 0; i < slices.size(); ++i) {
    plot.dots(slices[i].measured, kColors[i]);
    const auto l = det::sincos(-slices[i].light_deg * kDegree);
    Points curve;
    for (int step = -178; step <= 178; ++step) {
      const auto v = det::sincos(step * 0.5 * kDegree);
      const Vec3 f = materials::f64::brdf(fit.material, Vec3(l.sin, 0, l.cos),
                                          Vec3(v.sin, 0, v.cos), Vec3(0, 0, 1));
      const double value = band < 0 ? f.y : f[band];
      curve.emplace_back(step * 0.5, value > 0 ? det::log10(value) : bottom);
    }
    plot.curve(curve, kColors[i], fmt::format("light {}°", slices[i].light_deg));
  }
  return plot.finish();
}

}  // namespace panwright::tools
