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

// Over bumps too small to see. x, y: its slopes along s.tangent and across, theirs added; z: its shine,
// which says how far it is from a Gaussian of these slopes: what the bumps add is one. inside: of
// bump_inside()
FORMULA Vec3 blinn_phong_bumped(Surface s, Real inside) {
  Real m = blinn_phong_slope(s.shine);
  if (!(s.bump_x > Real(0))) return Vec3(m, m, s.shine);
  Real x = bumped(m, inside * s.bump_x);
  Real y = bumped(m, inside * s.bump_y);
  Real wider = x * y / (m * m);
  return Vec3(x, y, min(max(s.shine, Real(1e-3)) * wider * wider, Real(1e6)));
}

// What facets that mirror the light show more of than the surface does, as those of Cook and Torrance:
// 1 at the peak. share: of the bumps in the lobe's squared slopes
FORMULA Real blinn_phong_facets(Real share, Real cos_nl, Real cos_nv, Real both2) {
  Real small = min(cos_nl, cos_nv);
  Real large = max(cos_nl, cos_nv);
  Real sum2 = (cos_nl + cos_nv) * (cos_nl + cos_nv);
  Real cavity = max(Real(4) * small * large, both2 * large / (small + large));
  return Real(1) + share * (both2 * both2 * both2 / (sum2 * sum2 * cavity) - Real(1));
}

FORMULA Vec3 blinn_phong_over_x(Surface s, Vec3 lobe, Vec3 tilted) {
  if (lobe.x == lobe.y) return disc_x(tilted) / lobe.x;
  return over_slope_x(lobe.x, lobe.y, s.tangent, tilted);
}
FORMULA Vec3 blinn_phong_over_y(Surface s, Vec3 lobe, Vec3 tilted) {
  if (lobe.x == lobe.y) return disc_y(tilted) / lobe.x;
  return over_slope_y(lobe.x, lobe.y, s.tangent, tilted);
}

FORMULA Vec3 blinn_phong_lobe_from(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                                   Real index) {
  Vec3 lobe = blinn_phong_bumped(s, bump_inside(s, light.to_light, to_viewer, index));
  Real m = min(lobe.x, lobe.y);
  if (point_light(light, m, to_viewer, tilted) > Real(0)) return light.to_light;
  return lit_from(Real(0), light, m, blinn_phong_over_x(s, lobe, tilted), blinn_phong_over_y(s, lobe, tilted),
                  to_viewer, normal, tilted, index);
}

FORMULA Real blinn_phong_lobe(Surface s, Vec3 from, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                              Real index) {
  Vec3 l = below_index(from, normal, index);
  Vec3 v = below_index(to_viewer, normal, index);
  Vec3 lobe = blinn_phong_bumped(s, bump_inside(s, light.to_light, to_viewer, index));
  Real m = min(lobe.x, lobe.y);
  bool point = point_light(light, m, to_viewer, tilted) > Real(0);
  if (point && !(s.bump_x > Real(0))) return blinn_phong(s.shine, l, v, tilted);
  Real cos_nl = dot3(tilted, l);
  Real cos_nv = dot3(tilted, v);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  // the lobe's volume stays what it was
  Real scale = blinn_phong_scale(s.shine);
  if (s.bump_x > Real(0)) {
    Real own = blinn_phong_slope(s.shine);
    Real own_share = own * own / (lobe.x * lobe.y);
    Vec3 between = l + v;
    scale = scale * own_share *
            blinn_phong_facets(Real(1) - own_share, max(cos_nl, Real(1e-10)), max(cos_nv, Real(1e-10)), dot3(between, between));
  }
  if (point) {
    Vec3 both = l + v;
    if (dot3(both, both) < Real(1e-12)) return Real(0);
    Real cos_sum = max(cos_nl + cos_nv, Real(1e-10));
    Real square = over_slopes(lobe.x, lobe.y, s.tangent, cross3(tilted, both), tilted) / (cos_sum * cos_sum);
    return scale * exp_negative(Real(0.5) * lobe.z * log_one_plus(min(square * Real(2) / lobe.z, Real(1e30))));
  }
  Real density = density_over_disc(Real(0), max(lobe.z, Real(1e-3)), light, m,
                                   blinn_phong_over_x(s, lobe, tilted), blinn_phong_over_y(s, lobe, tilted), from,
                                   to_viewer, normal, tilted, index);
  return scale * density;
}
