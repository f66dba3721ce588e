// microfacets with Beckmann slopes in V-cavities: F D G / (4 (n.l) (n.v)), D normalised so that
// the microfacets' projections add up to the surface. 1/sr.
// R. L. Cook, K. E. Torrance, "A reflectance model for computer graphics", 1982. Their print has no
// 1/pi in D but one beside F and no 4: it is four times as bright and reflects more than it gets.

FORMULA Real cook_torrance_slope(Real slope) { return min(max(slope, Real(1e-6)), Real(1000)); }

// D, 1/sr. slope: RMS m of the microfacets, taken as 1e-6 (a thousandth of what the Sun's disc blurs)
// when smaller and as 1000 when larger.
FORMULA Real beckmann(Real tan2, Real slope) {
  Real m = cook_torrance_slope(slope);
  Real x = tan2 / (m * m);
  if (!(x < Real(80))) return Real(0);
  Real secant2 = Real(1) + tan2;
  return exp_negative(x) * secant2 * secant2 * Real(0.31830988618379067) / (m * m);
}

// G / (4 (n.l) (n.v)) with G = min(1, 2 (n.h) (n.v)/(v.h), 2 (n.h) (n.l)/(v.h)); bounded towards
// grazing. both2: |l + v|^2
FORMULA Real v_cavity(Real cos_nl, Real cos_nv, Real both2) {
  Real small = min(cos_nl, cos_nv);
  Real large = max(cos_nl, cos_nv);
  return Real(1) / max(Real(4) * small * large, both2 * large / (small + large));
}

// D G / (4 (n.l) (n.v)): the whole lobe but for the Fresnel reflectance of the microfacets.
FORMULA Real cook_torrance(Real slope, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  cos_nl = max(cos_nl, Real(1e-10));
  cos_nv = max(cos_nv, Real(1e-10));
  Vec3 both = to_light + to_viewer;
  Real both2 = dot3(both, both);
  if (both2 < Real(1e-12)) return Real(0);
  Real d = beckmann(half_tan2(to_light, to_viewer, normal, cos_nl + cos_nv), slope);
  return d * v_cavity(cos_nl, cos_nv, both2);
}

// The lobe as printed in 1981 and 1982, for models that were tuned with it. Not for new ones.
FORMULA Real cook_torrance_as_printed(Real slope, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return Real(4) * cook_torrance(slope, to_light, to_viewer, normal);
}

// Under the Sun's disc: see sunlit_from() and density_over_disc().
FORMULA Vec3 cook_torrance_from(Surface s, Real slope, Vec3 to_light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                                Real index) {
  Real m = cook_torrance_slope(slope);
  if (point_sun(s.sun_alpha2, m, to_light, to_viewer, tilted) > Real(0)) return to_light;
  return sunlit_from(Real(0), s.sun_limb, disc_radius(s.sun_alpha2), m, disc_x(tilted) / m, disc_y(tilted) / m,
                     to_light, to_viewer, normal, tilted, index);
}

FORMULA Real cook_torrance_sunlit(Surface s, Real slope, Vec3 from, Vec3 to_light, Vec3 to_viewer, Vec3 normal,
                                  Vec3 tilted, Real index) {
  Vec3 l = below_index(from, normal, index);
  Vec3 v = below_index(to_viewer, normal, index);
  Real m = cook_torrance_slope(slope);
  if (point_sun(s.sun_alpha2, m, to_light, to_viewer, tilted) > Real(0)) return cook_torrance(slope, l, v, tilted);
  Real cos_nl = dot3(tilted, l);
  Real cos_nv = dot3(tilted, v);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  cos_nl = max(cos_nl, Real(1e-10));
  cos_nv = max(cos_nv, Real(1e-10));
  Vec3 both = l + v;
  Real both2 = dot3(both, both);
  if (both2 < Real(1e-12)) return Real(0);
  Real density = density_over_disc(Real(0), Real(0), s.sun_limb, disc_radius(s.sun_alpha2), m, disc_x(tilted) / m,
                                   disc_y(tilted) / m, from, to_light, to_viewer, normal, tilted, index);
  Real secant2 = Real(1) + half_tan2(l, v, tilted, cos_nl + cos_nv);
  return density * secant2 * secant2 * Real(0.31830988618379067) / (m * m) * v_cavity(cos_nl, cos_nv, both2);
}

FORMULA Vec3 cook_torrance_lobe_from(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                                     Real index) {
  return cook_torrance_from(s, s.alpha_x, to_light, to_viewer, normal, tilted, index);
}

FORMULA Real cook_torrance_lobe(Surface s, Vec3 from, Vec3 to_light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                                Real index) {
  return s.d_scale * s.f_scale * s.g_scale *
         cook_torrance_sunlit(s, s.alpha_x, from, to_light, to_viewer, normal, tilted, index);
}
