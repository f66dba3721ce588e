// Fits that replace integrals.
#include <cmath>

#include "materials/internal/fits.h"
#include "materials/internal/formulas.h"
#include "materials/material.h"

namespace panwright::materials {
namespace {

Vec3 f0_of(const Material& material) {
  if (!info_of(material.specular_model()).microfacet) return Vec3(0);
  const double outer = material.coat ? material.coat->index : 1;
  return f64::composition_of(material).own_fresnel(f64::surface_of(material), 1, outer);
}

}  // namespace

double porosity_factor(double filling) {
  if (!(filling > 0)) return 1;
  const double x = 1.209 * det::exp(det::log(filling) * (2.0 / 3));
  return -det::log(1 - x) / x;
}

void fit(Material& material) {
  material.fits = {};
  material.fits.f0 = f0_of(material);
  fit_hapke(material);
  fit_microfacets(material);
  fit_coat(material);
}

}  // namespace panwright::materials
