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

FORMULA Real blinn_phong_lobe(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return blinn_phong(s.shine, to_light, to_viewer, normal);
}
