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

FORMULA Vec3 fresnel_rgb(Real cos_i, Vec3 indices) {
  return Vec3(fresnel_dielectric(cos_i, indices.x), fresnel_dielectric(cos_i, indices.y),
              fresnel_dielectric(cos_i, indices.z));
}
