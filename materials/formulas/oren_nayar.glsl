// Diffuse V-cavities whose slopes are Gaussian with standard deviation sigma (radians), with one
// interreflection. 1/sr, the albedo included: the second term goes with its square. Where the fit
// turns negative (steep microfacets, backward azimuths, both angles near grazing) it is 0.
// M. Oren, S. K. Nayar, "Generalization of Lambert's reflectance model", 1994, equations 27 and 28.
FORMULA Vec3 oren_nayar(Vec3 albedo, Real sigma, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Vec3(Real(0));
  cos_nl = max(cos_nl, Real(1e-10));
  cos_nv = max(cos_nv, Real(1e-10));

  Vec3 along_l = along_surface(to_light, normal, cos_nl);
  Vec3 along_v = along_surface(to_viewer, normal, cos_nv);
  Real sin_nl = length3(along_l);
  Real sin_nv = length3(along_v);
  Vec3 turn = azimuth(along_l, along_v, sin_nl * sin_nv);
  Real cos_phi = turn.x;

  // a: the larger angle, b: the smaller
  Real sin_a = max(sin_nl, sin_nv);
  Real cos_a = min(cos_nl, cos_nv);
  Real sin_b = min(sin_nl, sin_nv);
  Real cos_b = max(cos_nl, cos_nv);
  Real a = angle_of(sin_a, cos_a) * Real(0.63661977236758134);
  Real b = angle_of(sin_b, cos_b) * Real(0.63661977236758134);

  Real s2 = sigma * sigma;
  Real wide = s2 / (s2 + Real(0.09));
  Real c1 = Real(1) - Real(0.5) * s2 / (s2 + Real(0.33));
  Real c2 = sin_a;
  if (cos_phi < Real(0)) {
    // sin a - b^3 as (1 - b^3) - (1 - sin a): each is small near grazing, where tan b is large
    Real from_horizon = angle_of(cos_b, sin_b) * Real(0.63661977236758134);
    c2 = from_horizon * (Real(1) + b + b * b) - cos_a * cos_a / (Real(1) + sin_a);
  }
  Real c3 = Real(0.125) * wide * (a * b) * (a * b);
  Real direct = c1 + Real(0.45) * wide * c2 * cos_phi * (sin_b / cos_b) +
                turn.z * c3 * ((sin_a + sin_b) / (cos_a + cos_b));
  Real twice = Real(0.17) * s2 / (s2 + Real(0.13)) * (Real(1) - cos_phi * b * b);
  return albedo * ((max(direct, Real(0)) + albedo * twice) * Real(0.31830988618379067));
}

FORMULA Vec3 oren_nayar_brdf(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return oren_nayar(s.diffuse, s.oren, to_light, to_viewer, normal);
}
