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

// The same with slopes that differ along two axes.
FORMULA Real cook_torrance_along(Real slope_x, Real slope_y, Vec3 tangent, Vec3 to_light, Vec3 to_viewer,
                                 Vec3 normal) {
  if (isotropic(slope_x, slope_y, tangent) > Real(0))
    return cook_torrance(sqrt(slope_x * slope_y), to_light, to_viewer, normal);
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  cos_nl = max(cos_nl, Real(1e-10));
  cos_nv = max(cos_nv, Real(1e-10));
  Vec3 both = to_light + to_viewer;
  Real both2 = dot3(both, both);
  if (both2 < Real(1e-12)) return Real(0);
  Vec3 turned = cross3(normal, both);
  Real scale = Real(1) / ((cos_nl + cos_nv) * (cos_nl + cos_nv));
  Real density = exp_negative(over_slopes(slope_x, slope_y, tangent, turned, normal) * scale);
  Real secant2 = Real(1) + dot3(turned, turned) * scale;
  return density * secant2 * secant2 * Real(0.31830988618379067) / (slope_x * slope_y) *
         v_cavity(cos_nl, cos_nv, both2);
}

// Under the light's disc: see lit_from() and density_over_disc(). Slopes: along s.tangent and across.
FORMULA Vec3 cook_torrance_from(Surface s, Real slope_x, Real slope_y, Incidence light, Vec3 to_viewer, Vec3 normal,
                                Vec3 tilted, Real index) {
  Real mx = cook_torrance_slope(slope_x);
  Real my = cook_torrance_slope(slope_y);
  Real m = min(mx, my);
  if (point_light(light, m, to_viewer, tilted) > Real(0)) return light.to_light;
  Vec3 over_x = disc_x(tilted) / m;
  Vec3 over_y = disc_y(tilted) / m;
  if (mx != my) {
    over_x = over_slope_x(mx, my, s.tangent, tilted);
    over_y = over_slope_y(mx, my, s.tangent, tilted);
  }
  return lit_from(Real(0), light, m, over_x, over_y, to_viewer, normal, tilted, index);
}

FORMULA Real cook_torrance_lit(Surface s, Real slope_x, Real slope_y, Vec3 from, Incidence light, Vec3 to_viewer,
                                  Vec3 normal, Vec3 tilted, Real index) {
  Vec3 l = below_index(from, normal, index);
  Vec3 v = below_index(to_viewer, normal, index);
  Real mx = cook_torrance_slope(slope_x);
  Real my = cook_torrance_slope(slope_y);
  Real m = min(mx, my);
  if (point_light(light, m, to_viewer, tilted) > Real(0)) {
    if (mx != my) return cook_torrance_along(mx, my, s.tangent, l, v, tilted);
    return cook_torrance(slope_x, l, v, tilted);
  }
  Real cos_nl = dot3(tilted, l);
  Real cos_nv = dot3(tilted, v);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  cos_nl = max(cos_nl, Real(1e-10));
  cos_nv = max(cos_nv, Real(1e-10));
  Vec3 both = l + v;
  Real both2 = dot3(both, both);
  if (both2 < Real(1e-12)) return Real(0);
  Vec3 over_x = disc_x(tilted) / m;
  Vec3 over_y = disc_y(tilted) / m;
  if (mx != my) {
    over_x = over_slope_x(mx, my, s.tangent, tilted);
    over_y = over_slope_y(mx, my, s.tangent, tilted);
  }
  Real density = density_over_disc(Real(0), Real(0), light, m, over_x, over_y, from, to_viewer, normal, tilted, index);
  Real secant2 = Real(1) + half_tan2(l, v, tilted, cos_nl + cos_nv);
  return density * secant2 * secant2 * Real(0.31830988618379067) / (mx * my) * v_cavity(cos_nl, cos_nv, both2);
}

FORMULA Vec3 cook_torrance_lobe_from(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                                     Real index) {
  Real inside = bump_inside(s, light.to_light, to_viewer, index);
  return cook_torrance_from(s, bumped(s.alpha_x, inside * s.bump_x), bumped(s.alpha_x, inside * s.bump_y), light,
                            to_viewer, normal, tilted, index);
}

FORMULA Real cook_torrance_lobe(Surface s, Vec3 from, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                                Real index) {
  Real inside = bump_inside(s, light.to_light, to_viewer, index);
  return s.d_scale * s.f_scale * s.g_scale *
         cook_torrance_lit(s, bumped(s.alpha_x, inside * s.bump_x), bumped(s.alpha_x, inside * s.bump_y), from,
                              light, to_viewer, normal, tilted, index);
}
