#include "light/photometry.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace panwright::light {
namespace {

// Share of Lommel and Seeliger in the lunar law: A. McEwen, "A precise lunar photometric function",
// 1996. Its polynomial is below 0 beyond 100 degrees.
double lunar_share(double phase) {
  const double a = phase / kDegree;
  return std::clamp(1 + a * (-0.019 + a * (2.42e-4 - a * 1.46e-6)), 0.0, 1.0);
}

double mixed(double share, double mu0, double mu) {
  return share * 2 * mu0 / (mu0 + mu) + (1 - share) * mu0;
}

double hapke(const Photometry& law, double mu0, double mu, double phase) {
  const double g = law.asymmetry, w = law.single_scattering;
  const double lobe = std::max(1 + 2 * g * det::cos(phase) + g * g, 1e-12);
  const double scattered = (1 - g * g) / (lobe * std::sqrt(lobe));
  const double half = std::min(0.5 * phase, 0.4999 * kPi);
  const double surge = law.surge / (1 + det::tan(half) / law.surge_width);
  const double gamma = std::sqrt(1 - w);
  const auto h = [&](double x) { return (1 + 2 * x) / (1 + 2 * x * gamma); };
  return 0.25 * w * mu0 / (mu0 + mu) * ((1 + surge) * scattered + h(mu0) * h(mu) - 1);
}

double lambert_disc(double phase) {
  const det::SinCos a = det::sincos(phase);
  return 2 / (3 * kPi) * (a.sin + (kPi - phase) * a.cos);
}

// 1 − sin(a/2)·tan(a/2)·ln cot(a/4)
double seeliger_disc(double phase) {
  if (phase < 1e-6) return 1;
  if (phase > kPi - 1e-6) return 0;
  const det::SinCos half = det::sincos(0.5 * phase);
  return std::max(0.0, 1 + half.sin * half.sin / half.cos * det::log(det::tan(0.25 * phase)));
}

// In photometric longitude and latitude, midpoints.
double disc_by_quadrature(const Photometry& law, double phase) {
  constexpr int kSteps = 64;
  double sum = 0;
  const double width = (kPi - phase) / kSteps, height = kPi / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double longitude = phase - 0.5 * kPi + (i + 0.5) * width;
    for (int j = 0; j < kSteps; ++j) {
      const double cosine = det::cos(-0.5 * kPi + (j + 0.5) * height);
      const double mu = cosine * det::cos(longitude), mu0 = cosine * det::cos(longitude - phase);
      sum += radiance_factor(law, mu0, mu, phase) * mu * cosine;
    }
  }
  return sum * width * height / kPi;
}

}  // namespace

double radiance_factor(const Photometry& law, double mu0, double mu, double phase) {
  if (!(mu0 > 0 && mu > 0)) return 0;
  switch (law.law) {
    case Law::lambert:
      return mu0;
    case Law::lommel_seeliger:
      return mixed(1, mu0, mu);
    case Law::lunar_lambert:
      return mixed(lunar_share(phase), mu0, mu);
    case Law::hapke:
      return hapke(law, mu0, mu, phase);
  }
  return 0;
}

double disc_reflectance(const Photometry& law, double phase) {
  phase = std::clamp(phase, 0.0, kPi);
  switch (law.law) {
    case Law::lambert:
      return lambert_disc(phase);
    case Law::lommel_seeliger:
      return seeliger_disc(phase);
    case Law::lunar_lambert: {
      const double share = lunar_share(phase);
      return share * seeliger_disc(phase) + (1 - share) * lambert_disc(phase);
    }
    case Law::hapke:
      return disc_by_quadrature(law, phase);
  }
  return 0;
}

// H. Kieffer, T. Stone, "The spectral irradiance of the Moon", 2005, table 4 and eq. 10; the Sun's
// selenographic longitude is taken as the phase.
Vec3 rolo_reflectance(double phase) {
  struct Band {
    double a[4], b[3], d[3];
  };
  static constexpr std::array<Band, 3> kBands = {{
      {{-1.88914, -1.58096, 0.30477, -0.17908},
       {0.04415, 0.00983, -0.00389},
       {0.37141, -0.13514, 0.01248}},
      {{-2.12504, -1.65970, 0.38409, -0.20655},
       {0.04052, 0.01009, -0.00388},
       {0.37206, -0.10745, 0.00347}},
      {{-2.23351, -1.68573, 0.37632, -0.19877},
       {0.03881, 0.01566, -0.00555},
       {0.36590, -0.08945, 0.00678}},
  }};
  const double g = std::clamp(phase, 1.55 * kDegree, 150 * kDegree);
  const double degrees = g / kDegree;
  const double cube = g * g * g;
  Vec3 result;
  for (int k = 0; k < 3; ++k) {
    const Band& c = kBands[static_cast<std::size_t>(k)];
    result[k] = det::exp(
        c.a[0] + g * (c.a[1] + g * (c.a[2] + g * c.a[3])) + c.b[0] * g + c.b[1] * cube +
        c.b[2] * cube * g * g + c.d[0] * det::exp(-degrees / 4.06054) +
        c.d[1] * det::exp(-degrees / 12.8802) + c.d[2] * det::cos((degrees + 30.5858) / 16.7498));
  }
  return result;
}

Vec3 phase_factor(const Photometry& law, double phase) {
  if (!law.rolo) return Vec3(1);
  const double g = std::min(phase, 150 * kDegree);
  return rolo_reflectance(g) / std::max(disc_reflectance(law, g), 1e-9);
}

}  // namespace panwright::light
