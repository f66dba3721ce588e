// Numbers that stand in the place of integrals.
#include <cmath>

#include "materials/internal/fits.h"
#include "materials/material.h"

namespace panwright::materials {

double porosity_factor(double filling) {
  if (!(filling > 0)) return 1;
  const double x = 1.209 * det::exp(det::log(filling) * (2.0 / 3));
  return -det::log(1 - x) / x;
}

void fit(Material& material) {
  material.fits = {};
  fit_hapke(material);
  fit_facets(material);
  fit_coat(material);
}

}  // namespace panwright::materials
