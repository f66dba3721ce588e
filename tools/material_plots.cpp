#include "tools/material_plots.h"

#include <fmt/core.h>

#include <algorithm>
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

constexpr const char* kLightColors[] = {"#222222", "#2c6fbb", "#27ae60", "#c0392b"};

// Plot over the viewing angle, −90° to 90°, without curves.
Plot lobe_plot(double bottom, double top) {
  return {
      .left = -90, .right = 90, .bottom = bottom, .top = top, .logarithmic = true, .x_step = 30};
}

// Direction in the plane of incidence.
Vec3 direction_at(double degrees) {
  const auto t = det::sincos(degrees * kDegree);
  return Vec3(t.sin, 0, t.cos);
}

}  // namespace

std::string albedo_plot(const materials::Material& material) {
  Plot plot{
      .title = material.name + ": directional albedo",
      .x_name = "angle from the normal, degrees",
      .y_name = "albedo",
      .right = 90,
      .x_step = 15,
      .curves = {{{}, "#c0392b", "650 nm"}, {{}, "#27ae60", "550 nm"}, {{}, "#2c6fbb", "450 nm"}}};
  for (const int angle :
       {0, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 75, 80, 83, 86, 88}) {
    const Vec3 albedo = materials::directional_albedo(material, det::cos(angle * kDegree));
    for (int k = 0; k < 3; ++k)
      plot.curves[static_cast<std::size_t>(k)].points.emplace_back(angle, albedo[k]);
  }
  return svg_of(plot);
}

std::string slices_plot(const materials::Material& material) {
  constexpr int kLights_deg[] = {0, 30, 60, 80};
  const materials::ShadingContext local{Vec3(1, 0, 0)};
  std::vector<PlotCurve> curves;
  double peak = 1e-30;
  for (std::size_t i = 0; i < 4; ++i) {
    PlotPoints& points =
        curves
            .emplace_back(PlotCurve{{}, kLightColors[i], fmt::format("light {}°", kLights_deg[i])})
            .points;
    // note: half a degree apart, and finely about the mirrored direction and the light
    for (int step = -1780; step <= 1780; ++step) {
      const double angle = step * 0.05;
      const double glint =
          std::min(std::fabs(angle - kLights_deg[i]), std::fabs(angle + kLights_deg[i]));
      if (step % 10 != 0 && glint > 3) continue;
      const Vec3 f =
          materials::f64::brdf(material, materials::sunlight(direction_at(-kLights_deg[i])),
                               direction_at(angle), Vec3(0, 0, 1), Vec3(1), local);
      const double value = kPi * (f.x + f.y + f.z) / 3;
      peak = std::max(peak, value);
      points.emplace_back(angle, value);
    }
  }
  const double top = std::ceil(det::log10(peak));
  const double bottom = std::max(top - 6, -4.0) < top - 2 ? std::max(top - 6, -4.0) : top - 2;
  Plot plot = lobe_plot(bottom, top);
  plot.title = material.name + ": reflectance in the plane of incidence";
  plot.x_name = "viewing angle, degrees (light from the left, its mirror image to the right)";
  plot.y_name = "π f";
  plot.curves = std::move(curves);
  return svg_of(plot);
}

std::string fit_plot(const std::vector<materials::Reading>& readings, const materials::Fit& fit,
                     const std::string& name, int band) {
  // viewing angles are positive on the far side of the normal from the light
  struct Slice {
    int light_deg;
    PlotPoints measured;
  };
  std::vector<Slice> slices;
  double least = 1, most = 1e-6;
  for (const materials::Reading& r : readings) {
    if (std::fabs(r.to_light.x * r.to_viewer.y - r.to_light.y * r.to_viewer.x) > 1e-6) continue;
    const int light = static_cast<int>(std::lround(det::acos(r.to_light.z) / kDegree));
    auto at = std::find_if(slices.begin(), slices.end(),
                           [&](const Slice& s) { return s.light_deg == light; });
    if (at == slices.end()) {
      if (slices.size() == std::size(kLightColors)) continue;
      at = slices.insert(slices.end(), {light, {}});
    }
    const double side = r.to_light.x * r.to_viewer.x + r.to_light.y * r.to_viewer.y;
    const double angle = det::acos(std::clamp(r.to_viewer.z, -1.0, 1.0)) / kDegree;
    const double reflectance = std::max(band < 0 ? r.reflectance : r.rgb[band], 1e-4);
    at->measured.emplace_back(side > 0 ? -angle : angle, reflectance);
    least = std::min(least, reflectance);
    most = std::max(most, reflectance);
  }
  const double bottom = std::floor(det::log10(least));
  const double top = std::max(std::ceil(det::log10(most)), bottom + 1);
  constexpr const char* kBands[] = {" in red", " in green", " in blue"};
  Plot plot = lobe_plot(bottom, top);
  plot.title = fmt::format("{}{}: readings, and {} ({:.3f} decades RMS)", name,
                           band < 0 ? "" : kBands[band], fit.brdf, fit.rms_decades);
  plot.x_name = "viewing angle, degrees (light from the left)";
  plot.y_name = "f, 1/sr";
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const Vec3 light = direction_at(-slices[i].light_deg);
    PlotPoints curve;
    for (int step = -178; step <= 178; ++step) {
      const Vec3 f =
          materials::f64::brdf(fit.material, light, direction_at(step * 0.5), Vec3(0, 0, 1));
      curve.emplace_back(step * 0.5, band < 0 ? f.y : f[band]);
    }
    plot.curves.push_back({curve, kLightColors[i], fmt::format("light {}°", slices[i].light_deg),
                           slices[i].measured});
  }
  return svg_of(plot);
}

}  // namespace panwright::tools
