#include "materials/spectra.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "materials/internal/formulas.h"
#include "materials/internal/optical_tables.h"

namespace panwright::materials {
namespace {

constexpr std::array<std::string_view, 10> kMetals{"Ag", "Al", "Au", "Cu",       "GaAs",
                                                   "Ge", "Si", "Ti", "graphite", "steel"};

const OpticalTable* table_of(std::string_view name) {
  for (const OpticalTable& table : kOpticalTables)
    if (table.name == name) return &table;
  return nullptr;
}

}  // namespace

std::optional<Conductor> metal(std::string_view name) {
  if (std::find(kMetals.begin(), kMetals.end(), name) == kMetals.end()) return std::nullopt;
  const OpticalTable& table = *table_of(name);
  Conductor result;
  constexpr std::array kBands{0.65, 0.55, 0.45};
  for (int channel = 0; channel < 3; ++channel) {
    // the grid holds these three
    const auto at = std::find(kWavelengths.begin(), kWavelengths.end(),
                              kBands[static_cast<std::size_t>(channel)]);
    assert(at != kWavelengths.end());
    const auto i = static_cast<std::size_t>(at - kWavelengths.begin());
    result.n[channel] = table.n[i];
    result.k[channel] = table.k[i];
  }
  return result;
}

std::span<const std::string_view> metal_names() { return kMetals; }

std::span<const double> wavelengths_um() { return kWavelengths; }

std::span<const std::string_view> film_names() {
  static constexpr std::string_view kFilms[] = {"Kapton", "MgF2", "SiO2"};
  return kFilms;
}

std::optional<Conductor> film(std::string_view name) {
  const auto known = film_names();
  if (std::find(known.begin(), known.end(), name) == known.end()) return std::nullopt;
  const auto constants = optical_constants(name);
  if (!constants) return std::nullopt;
  const auto grid = wavelengths_um();
  Conductor out;
  for (int channel = 0; channel < 3; ++channel) {
    const double band = kBands_um[static_cast<std::size_t>(channel)];
    const auto above = std::upper_bound(grid.begin(), grid.end(), band);
    const auto i = static_cast<std::size_t>(above - grid.begin()) - 1;
    const double t = (band - grid[i]) / (grid[i + 1] - grid[i]);
    out.n[channel] = constants->n[i] + t * (constants->n[i + 1] - constants->n[i]);
    out.k[channel] = constants->k[i] + t * (constants->k[i + 1] - constants->k[i]);
  }
  return out;
}

Coat coat_of_film(const Conductor& film, double thickness) {
  Coat coat;
  coat.index = film.n.y;
  for (int k = 0; k < 3; ++k)
    coat.depth[k] =
        4 * kPi * film.k[k] / (kBands_um[static_cast<std::size_t>(k)] * 1e-6) * thickness;
  return coat;
}

std::optional<Coat> coat_of_film(std::string_view name, double thickness) {
  const auto bands = film(name);
  const auto constants = optical_constants(name);
  if (!bands || !constants) return std::nullopt;
  Coat coat;
  coat.index = bands->n.y;
  // note: black paint's share; the front of the film reflects more
  constexpr double kDarkest = 1e-4;
  for (int channel = 0; channel < 3; ++channel) {
    double passed = 0;
    for (std::size_t i = 0; i < kWavelengths.size(); ++i)
      passed += kSunlitColor[static_cast<std::size_t>(channel)][i] *
                det::exp(-8 * kPi * constants->k[i] / (kWavelengths[i] * 1e-6) * thickness);
    coat.depth[channel] = -0.5 * det::log(std::clamp(passed, kDarkest, 1.0));
  }
  const bool clear =
      std::all_of(constants->k.begin(), constants->k.end(), [](double k) { return k == 0; });
  if (clear) coat.depth = Vec3(0);
  return coat;
}

std::optional<OpticalConstants> optical_constants(std::string_view name) {
  const OpticalTable* table = table_of(name);
  if (!table) return std::nullopt;
  return OpticalConstants{table->what, table->n, table->k};
}

double reflectance(const Stack& stack, std::size_t wavelength, double cosine) {
  const double n = stack.body.n[wavelength];
  const double k = stack.body.k[wavelength];
  if (!stack.film) return f64::fresnel_conductor(cosine, n, k);
  const double outer = stack.film->n[wavelength];
  const double inside = f64::refracted_cosine(cosine, outer);
  const double first = f64::fresnel_dielectric(cosine, outer);
  const double second = f64::fresnel_conductor(inside, n / outer, k / outer);
  const double depth =
      4 * kPi * stack.film->k[wavelength] * stack.thickness / (kWavelengths[wavelength] * 1e-6);
  return first + f64::slab_remainder(first, Vec3(second), Vec3(depth), inside).x;
}

double solar_absorptance(const Stack& stack, double cosine) {
  double sum = 0;
  for (std::size_t i = 0; i < kWavelengths.size(); ++i)
    sum += kSolarShares[i] * (1 - reflectance(stack, i, cosine));
  return sum;
}

double hemispherical_solar_absorptance(const Stack& stack) {
  // midpoints of cos²
  constexpr int kSteps = 200;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) sum += solar_absorptance(stack, std::sqrt((i + 0.5) / kSteps));
  return sum / kSteps;
}

}  // namespace panwright::materials
