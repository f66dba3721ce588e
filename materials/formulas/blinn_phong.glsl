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

// Over bumps too small to see: a lobe has the squared slopes 2/(shine + 2) and theirs. x, y: the
// slopes along s.tangent and across; z: the shine of their geometric mean. inside: of
// bump_inside()
FORMULA Vec3 blinn_phong_bumped(Surface s, Real inside) {
  if (!(s.bump_x > Real(0))) return Vec3(Real(1), Real(1), s.shine);
  Real own = Real(2) / (s.shine + Real(2));
  Real x2 = own + inside * s.bump_x;
  Real y2 = own + inside * s.bump_y;
  return Vec3(sqrt(x2), sqrt(y2), max(Real(2) / sqrt(x2 * y2) - Real(2), Real(0)));
}

// Slopes over the lobe's; stretch: see above
FORMULA Vec3 blinn_phong_over_x(Surface s, Real m, Vec3 stretch, Vec3 tilted) {
  if (stretch.x == stretch.y) return disc_x(tilted) / m;
  Real ratio = sqrt(stretch.x / stretch.y);
  return over_slope_x(m * ratio, m / ratio, s.tangent, tilted);
}
FORMULA Vec3 blinn_phong_over_y(Surface s, Real m, Vec3 stretch, Vec3 tilted) {
  if (stretch.x == stretch.y) return disc_y(tilted) / m;
  Real ratio = sqrt(stretch.x / stretch.y);
  return over_slope_y(m * ratio, m / ratio, s.tangent, tilted);
}
// The smaller slope.
FORMULA Real blinn_phong_narrow(Real m, Vec3 stretch) {
  if (stretch.x == stretch.y) return m;
  return m * sqrt(min(stretch.x, stretch.y) / max(stretch.x, stretch.y));
}

FORMULA Vec3 blinn_phong_lobe_from(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                                   Real index) {
  Vec3 stretch = blinn_phong_bumped(s, bump_inside(s, to_light, to_viewer, index));
  Real m = blinn_phong_slope(stretch.z);
  Real least = blinn_phong_narrow(m, stretch);
  if (point_sun(s.sun_alpha2, least, to_light, to_viewer, tilted) > Real(0)) return to_light;
  return sunlit_from(Real(0), s.sun_limb, disc_radius(s.sun_alpha2), least, blinn_phong_over_x(s, m, stretch, tilted),
                     blinn_phong_over_y(s, m, stretch, tilted), to_light, to_viewer, normal, tilted, index);
}

FORMULA Real blinn_phong_lobe(Surface s, Vec3 from, Vec3 to_light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                              Real index) {
  Vec3 l = below_index(from, normal, index);
  Vec3 v = below_index(to_viewer, normal, index);
  Vec3 stretch = blinn_phong_bumped(s, bump_inside(s, to_light, to_viewer, index));
  Real shine = stretch.z;
  // the lobe's volume stays what it was
  Real scale = blinn_phong_scale(s.shine);
  if (s.bump_x > Real(0)) scale = scale * Real(2) / ((s.shine + Real(2)) * stretch.x * stretch.y);
  Real m = blinn_phong_slope(shine);
  Real least = blinn_phong_narrow(m, stretch);
  bool point = point_sun(s.sun_alpha2, least, to_light, to_viewer, tilted) > Real(0);
  if (point && !(s.bump_x > Real(0))) return blinn_phong(shine, l, v, tilted);
  Real cos_nl = dot3(tilted, l);
  Real cos_nv = dot3(tilted, v);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  if (point) {
    Vec3 both = l + v;
    if (dot3(both, both) < Real(1e-12)) return Real(0);
    Real ratio = sqrt(stretch.x / stretch.y);
    Real cos_sum = max(cos_nl + cos_nv, Real(1e-10));
    Real tan2 = over_slopes(ratio, Real(1) / ratio, s.tangent, cross3(tilted, both), tilted) / (cos_sum * cos_sum);
    return scale * exp_negative(Real(0.5) * shine * log_one_plus(min(tan2, Real(1e30))));
  }
  Real density = density_over_disc(Real(0), max(shine, Real(1e-3)), s.sun_limb, disc_radius(s.sun_alpha2), least,
                                   blinn_phong_over_x(s, m, stretch, tilted), blinn_phong_over_y(s, m, stretch, tilted),
                                   from, to_light, to_viewer, normal, tilted, index);
  return scale * density;
}
