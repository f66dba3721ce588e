// (n.h)^shine, times what makes the albedo at normal incidence 1. 1/sr.
// J. F. Blinn, "Models of light reflection for computer synthesized textures", 1977.

// integral over the hemisphere of (n.h)^shine (n.l) for v = n, inverted
FORMULA Real blinn_phong_scale(Real shine) {
  return (shine + Real(2)) * (shine + Real(4)) * Real(0.039788735772973834) /
         (exp_negative(Real(0.34657359027997265) * shine) + shine);
}

FORMULA Real blinn_phong(Real shine, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  Vec3 both = to_light + to_viewer;
  if (dot3(both, both) < Real(1e-12)) return Real(0);
  // (n.h)^-2 = 1 + tan^2
  Real tan2 = half_tan2(to_light, to_viewer, normal, max(cos_nl + cos_nv, Real(1e-10)));
  return blinn_phong_scale(shine) * exp_negative(Real(0.5) * shine * log_one_plus(tan2));
}

// As wide as a Gaussian of slopes over this.
FORMULA Real blinn_phong_slope(Real shine) { return sqrt(Real(2) / max(shine, Real(1e-3))); }

FORMULA Vec3 blinn_phong_lobe_from(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                                   Real index) {
  Real m = blinn_phong_slope(s.shine);
  if (point_sun(s.sun_alpha2, m, to_light, to_viewer, tilted) > Real(0)) return to_light;
  return sunlit_from(Real(0), s.sun_limb, disc_radius(s.sun_alpha2), m, disc_x(tilted) / m, disc_y(tilted) / m,
                     to_light, to_viewer, normal, tilted, index);
}

FORMULA Real blinn_phong_lobe(Surface s, Vec3 from, Vec3 to_light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                              Real index) {
  Vec3 l = below_index(from, normal, index);
  Vec3 v = below_index(to_viewer, normal, index);
  Real m = blinn_phong_slope(s.shine);
  if (point_sun(s.sun_alpha2, m, to_light, to_viewer, tilted) > Real(0)) return blinn_phong(s.shine, l, v, tilted);
  Real cos_nl = dot3(tilted, l);
  Real cos_nv = dot3(tilted, v);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  Real density = density_over_disc(Real(0), max(s.shine, Real(1e-3)), s.sun_limb, disc_radius(s.sun_alpha2), m, disc_x(tilted) / m,
                                   disc_y(tilted) / m, from, to_light, to_viewer, normal, tilted, index);
  return blinn_phong_scale(s.shine) * density;
}
