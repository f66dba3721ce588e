// Reflectance of unpolarised light at a smooth boundary to a dielectric of real refractive index,
// exact. cos_i >= 0; an index of 0 or less stands for a perfect mirror, F = 1.
// R. L. Cook, K. E. Torrance, "A reflectance model for computer graphics", 1982, with g - c written
// as (index^2 - 1)/(g + c): no digits are lost as the index goes to 1.
FORMULA Real fresnel_dielectric(Real cos_i, Real index) {
  if (!(index > Real(0))) return Real(1);
  Real excess = (index - Real(1)) * (index + Real(1));
  if (excess == Real(0)) return Real(0);
  Real g2 = excess + cos_i * cos_i;
  // total reflection
  if (g2 < Real(0)) return Real(1);
  Real g = sqrt(g2);
  Real sum = g + cos_i;
  Real difference = excess / sum;
  Real normal_part = difference / sum;
  Real ratio = (cos_i * sum - Real(1)) / (cos_i * difference + Real(1));
  Real reflected = Real(0.5) * normal_part * normal_part * (Real(1) + ratio * ratio);
  if (reflected < Real(0.5)) return reflected;
  // towards grazing what passes is small and keeps more digits
  Real passing = Real(2) * cos_i * g / (sum * sum);
  Real parallel = index * sum / (index * index * cos_i + g);
  return max(Real(1) - passing * (Real(1) + parallel * parallel), Real(0));
}

// The same towards a conductor of complex index n + ik, k >= 0.
FORMULA Real fresnel_conductor(Real cos_i, Real n, Real k) {
  Real sin2 = (Real(1) - cos_i) * (Real(1) + cos_i);
  // N^2 - sin^2, good beside n = 1 as well
  Real d = (n - Real(1)) * (n + Real(1)) + cos_i * cos_i - k * k;
  Real nk = Real(2) * n * k;
  // a + ib = sqrt(N^2 - sin^2), the smaller of the two by division
  Real size = sqrt(d * d + nk * nk);
  Real a = sqrt(max(Real(0.5) * (size + abs(d)), Real(1e-30)));
  Real b = Real(0.5) * nk / a;
  Real re = d < Real(0) ? b : a;
  Real im = d < Real(0) ? a : b;
  Real rs = ((cos_i - re) * (cos_i - re) + im * im) / ((cos_i + re) * (cos_i + re) + im * im);
  // tangential over normal: sin tan
  Real t = sin2 / max(cos_i, Real(1e-10));
  Real rp = rs * ((re - t) * (re - t) + im * im) / ((re + t) * (re + t) + im * im);
  return min(Real(0.5) * (rs + rp), Real(1));
}

// F of a surface whose reflectance at normal incidence is not F0 (f0) but R: linear in R, from 0
// to 1, F where R = F0. From F0 upwards it rises as Schlick's curve would with R; where a conductor
// dips below F0, in proportion. C. Schlick, "An inexpensive BRDF model for physically-based
// rendering", 1994.
FORMULA Real fresnel_from(Real fresnel, Real f0, Real reflectance) {
  if (fresnel < f0) return reflectance * (fresnel / f0);
  if (!(f0 < Real(0.999999))) return reflectance;
  Real rise = (fresnel - f0) / (Real(1) - f0);
  return reflectance + rise * (Real(1) - reflectance);
}

FORMULA Vec3 mapped_fresnel(Surface s, Vec3 fresnel) {
  return Vec3(fresnel_from(fresnel.x, s.f0.x, s.reflectance.x),
              fresnel_from(fresnel.y, s.f0.y, s.reflectance.y),
              fresnel_from(fresnel.z, s.f0.z, s.reflectance.z));
}

FORMULA Vec3 no_fresnel(Surface s, Real cos_i, Real outer) { return Vec3(Real(1)); }

// outer: refractive index of what lies over the microfacets
FORMULA Vec3 dielectric_fresnel(Surface s, Real cos_i, Real outer) {
  return Vec3(fresnel_dielectric(cos_i, s.indices.x / outer),
              fresnel_dielectric(cos_i, s.indices.y / outer),
              fresnel_dielectric(cos_i, s.indices.z / outer));
}

FORMULA Vec3 conductor_fresnel(Surface s, Real cos_i, Real outer) {
  return Vec3(fresnel_conductor(cos_i, s.indices.x / outer, s.extinction.x / outer),
              fresnel_conductor(cos_i, s.indices.y / outer, s.extinction.y / outer),
              fresnel_conductor(cos_i, s.indices.z / outer, s.extinction.z / outer));
}

// The same under a reflectance map.

FORMULA Vec3 mapped_no_fresnel(Surface s, Real cos_i, Real outer) { return s.reflectance; }

FORMULA Vec3 mapped_dielectric_fresnel(Surface s, Real cos_i, Real outer) {
  return mapped_fresnel(s, dielectric_fresnel(s, cos_i, outer));
}

FORMULA Vec3 mapped_conductor_fresnel(Surface s, Real cos_i, Real outer) {
  return mapped_fresnel(s, conductor_fresnel(s, cos_i, outer));
}
