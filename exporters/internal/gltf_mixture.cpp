#include "exporters/internal/gltf_mixture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace panwright::exporters {

namespace {

// Half a step of an 8-bit sRGB code about 0.04 is 0.0007, of the brightest 0.0045 of 1: what lies
// within it may as well be a dielectric or a metal and nothing else.
double rounding(double value) { return 7e-4 + 4e-3 * value; }

// The base colour for a share of the dielectric, and what is off.
Mixture with_share(const Vec3& diffuse, const Vec3& reflectance, double d, double share) {
  Mixture out;
  out.metallic = 1 - share;
  const double a = share * (1 - d), b = 1 - share;
  for (int c = 0; c < 3; ++c) {
    const double left = reflectance[c] - d * share;
    const double best = (a * diffuse[c] + b * left) / std::max(a * a + b * b, 1e-12);
    out.base[c] = std::clamp(best, 0.0, 1.0);
    out.error = std::max(
        {out.error, std::fabs(a * out.base[c] - diffuse[c]), std::fabs(b * out.base[c] - left)});
  }
  return out;
}

// The dielectric's share t of one channel: (R + A)·t − d·t² = A with A = D/(1 − d).
double share_of(double diffuse, double reflectance, double d) {
  const double a = diffuse / (1 - d), sum = reflectance + a;
  if (!(a > 0)) return reflectance > d ? 0 : 1;
  const double root = std::sqrt(std::max(sum * sum - 4 * d * a, 0.0));
  return std::min(2 * a / (sum + root), 1.0);
}

}  // namespace

Mixture mixture_of(const Vec3& diffuse, const Vec3& reflectance, double d, int levels) {
  const double all_diffuse = diffuse.x + diffuse.y + diffuse.z;
  const double all_reflected = reflectance.x + reflectance.y + reflectance.z;
  const double small = rounding((all_diffuse + all_reflected) / 3);
  const Mixture dielectric = with_share(diffuse, reflectance, d, 1);
  if (dielectric.error <= small) return dielectric;
  const Mixture metal = with_share(diffuse, reflectance, d, 0);
  if (metal.error <= small) return metal;
  Mixture best = dielectric.error <= metal.error ? dielectric : metal;
  const std::array<double, 4> shares = {
      share_of(all_diffuse / 3, all_reflected / 3, d), share_of(diffuse.x, reflectance.x, d),
      share_of(diffuse.y, reflectance.y, d), share_of(diffuse.z, reflectance.z, d)};
  for (double share : shares) {
    if (levels > 0) share = std::floor(share * levels + 0.5) / levels;
    const Mixture mixed = with_share(diffuse, reflectance, d, share);
    if (mixed.error < best.error) best = mixed;
  }
  return best;
}

}  // namespace panwright::exporters
