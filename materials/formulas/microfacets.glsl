// microfacets with Smith's masking, correlated by height, and what they scatter more than once.
// Slopes: RMS of the microfacets along the tangent (x) and across it (y). Where the two are one, or the
// tangent is 0, microfacets are isotropic and of slope sqrt(x y). 1/sr.
// B. Walter et al., "Microfacet models for refraction through rough surfaces", 2007; E. Heitz,
// "Understanding the masking-shadowing function in microfacet-based BRDFs", 2014.

// A slope within 1e-6 (a thousandth of what the Sun's disc blurs) to 1000.
FORMULA Real microfacet_slope(Real alpha, Real sun_alpha2) {
  return min(max(with_sun(alpha, sun_alpha2), Real(1e-6)), Real(1000));
}

// 1 where microfacets are isotropic, else 0.
FORMULA Real isotropic(Real slope_x, Real slope_y, Vec3 tangent) {
  if (slope_x == slope_y || !(dot3(tangent, tangent) > Real(0.25))) return Real(1);
  return Real(0);
}

// (x/slope_x)^2 + (y/slope_y)^2 of a vector in the surface, given its cross product with the normal.
FORMULA Real over_slopes(Real slope_x, Real slope_y, Vec3 tangent, Vec3 turned, Vec3 normal) {
  if (isotropic(slope_x, slope_y, tangent) > Real(0))
    return dot3(turned, turned) / (slope_x * slope_y);
  Real x = dot3(turned, cross3(normal, tangent)) / slope_x;
  Real y = dot3(turned, tangent) / slope_y;
  return x * x + y * y;
}

// slope times sine: the length of a direction's part in the surface, its axes scaled by the slopes
FORMULA Real sloped_sine(Real slope_x, Real slope_y, Vec3 tangent, Vec3 direction, Vec3 normal) {
  if (isotropic(slope_x, slope_y, tangent) > Real(0)) {
    Real cosine = dot3(normal, direction);
    return sqrt(max((Real(1) - cosine) * (Real(1) + cosine), Real(0)) * (slope_x * slope_y));
  }
  Real x = dot3(direction, tangent) * slope_x;
  Real y = dot3(direction, cross3(normal, tangent)) * slope_y;
  return sqrt(x * x + y * y);
}

// cosine Lambda(direction) of Beckmann microfacets, Lambda = (erf x - 1)/2 + exp(-x^2)/(2 x sqrt pi),
// x = cosine/sine: bounded towards grazing. Within 3e-15 sine in double, 2e-7 in float: a polynomial
// of 1/(1 + 0.3 x) for Lambda x exp(x^2), minimax under exp(-x^2).
FORMULA Real beckmann_masking(Real cosine, Real sine) {
  // Lambda < 1e-16
  if (cosine >= Real(5.6) * sine) return Real(0);
  Real x = cosine / sine;
  Real t = Real(1) / (Real(1) + Real(0.3) * x) - Real(0.6875);
  Real p = Real(-0.0635949796251416);
  p = p * t + Real(0.13444597955787024);
  p = p * t + Real(0.057034828024682016);
  p = p * t - Real(0.24702599946282916);
  p = p * t - Real(0.3282584665540643);
  p = p * t + Real(0.3054066544153305);
  p = p * t + Real(1.4398453753477176);
  p = p * t + Real(2.2876891545958924);
  p = p * t + Real(2.300274439752272);
  p = p * t + Real(1.6279693626360208);
  p = p * t + Real(0.8155773338058482);
  p = p * t + Real(0.2633077389780118);
  p = p * t + Real(0.040334451343971976);
  return sine * (exp_negative(x * x) * p);
}

// D G / (4 (n.l) (n.v)) with Beckmann's D.
FORMULA Real beckmann_smith(Real slope_x, Real slope_y, Vec3 tangent, Vec3 to_light, Vec3 to_viewer,
                            Vec3 normal) {
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  cos_nl = max(cos_nl, Real(1e-10));
  cos_nv = max(cos_nv, Real(1e-10));
  Vec3 both = to_light + to_viewer;
  if (dot3(both, both) < Real(1e-12)) return Real(0);
  Vec3 turned = cross3(normal, both);
  Real scale = Real(1) / ((cos_nl + cos_nv) * (cos_nl + cos_nv));
  Real spread = over_slopes(slope_x, slope_y, tangent, turned, normal) * scale;
  if (!(spread < Real(80))) return Real(0);
  Real secant2 = Real(1) + dot3(turned, turned) * scale;
  Real d = exp_negative(spread) * secant2 * secant2 * Real(0.31830988618379067) /
           (slope_x * slope_y);
  Real sine_l = sloped_sine(slope_x, slope_y, tangent, to_light, normal);
  Real sine_v = sloped_sine(slope_x, slope_y, tangent, to_viewer, normal);
  Real hidden = cos_nl * beckmann_masking(cos_nv, sine_v) + cos_nv * beckmann_masking(cos_nl, sine_l);
  return Real(0.25) * d / (cos_nl * cos_nv + hidden);
}

// The same with the distribution of Trowbridge and Reitz, GGX, under the Sun's disc (sun_alpha2, 0: a
// point). Blurring leaves its wide tails as they are: with a = alpha^2, q = a + 3 sun_alpha2 and
// t = 1/(1 + slope^2/q) the density is t^2 (k0 + k1 t + k2 t^2)/(pi q). Tail (k0) and sum are exact,
// k2 is that of small blurs; of the peak 1 % is missing at alpha = 0.01, 0.01 % at 0.03.
FORMULA Real ggx_blurred(Real slope_x, Real slope_y, Real sun_alpha2, Vec3 tangent, Vec3 to_light,
                         Vec3 to_viewer, Vec3 normal) {
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  cos_nl = max(cos_nl, Real(1e-10));
  cos_nv = max(cos_nv, Real(1e-10));
  Vec3 both = to_light + to_viewer;
  if (dot3(both, both) < Real(1e-12)) return Real(0);
  Vec3 turned = cross3(normal, both);
  Real sum2 = (cos_nl + cos_nv) * (cos_nl + cos_nv);
  Real wide_x = slope_x;
  Real wide_y = slope_y;
  if (sun_alpha2 > Real(0)) {
    wide_x = sqrt(slope_x * slope_x + Real(3) * sun_alpha2);
    wide_y = sqrt(slope_y * slope_y + Real(3) * sun_alpha2);
  }
  Real spread = over_slopes(wide_x, wide_y, tangent, turned, normal);
  Real ratio = (sum2 + dot3(turned, turned)) / (sum2 + spread);
  Real d = ratio * ratio * Real(0.31830988618379067) / (wide_x * wide_y);
  if (sun_alpha2 > Real(0)) {
    Real t = sum2 / (sum2 + spread);
    Real k0 = slope_x * slope_y / (wide_x * wide_y);
    Real k2 = Real(-6) * (k0 * k0) * (sun_alpha2 / (wide_x * wide_y));
    Real k1 = Real(2) * (Real(1) - k0 - k2 * Real(0.3333333333333333));
    d = d * (k0 + t * (k1 + t * k2));
  }
  Real sine_l = sloped_sine(slope_x, slope_y, tangent, to_light, normal);
  Real sine_v = sloped_sine(slope_x, slope_y, tangent, to_viewer, normal);
  Real toward_l = cos_nv * sqrt(cos_nl * cos_nl + sine_l * sine_l);
  Real toward_v = cos_nl * sqrt(cos_nv * cos_nv + sine_v * sine_v);
  return Real(0.5) * d / (toward_l + toward_v);
}

FORMULA Real ggx_smith(Real slope_x, Real slope_y, Vec3 tangent, Vec3 to_light, Vec3 to_viewer,
                       Vec3 normal) {
  return ggx_blurred(slope_x, slope_y, Real(0), tangent, to_light, to_viewer, normal);
}

FORMULA Real beckmann_lobe(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return beckmann_smith(microfacet_slope(s.alpha_x, s.sun_alpha2), microfacet_slope(s.alpha_y, s.sun_alpha2),
                        s.tangent, to_light, to_viewer, normal);
}

FORMULA Real ggx_lobe(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return ggx_blurred(microfacet_slope(s.alpha_x, Real(0)), microfacet_slope(s.alpha_y, Real(0)), s.sun_alpha2,
                     s.tangent, to_light, to_viewer, normal);
}

// What a mirror shows of the Sun's even disc, whose squared radius is 8 sun_alpha2. 0 under a Sun
// without a disc: that is a direction, not a lobe.
FORMULA Real disc_lobe(Real sun_alpha2, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  if (!(sun_alpha2 > Real(0))) return Real(0);
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  // the chord from the light to the mirrored viewer
  Vec3 turned = cross3(normal, to_light + to_viewer);
  Real apart = cos_nl - cos_nv;
  if (!(dot3(turned, turned) + apart * apart < Real(8) * sun_alpha2)) return Real(0);
  return Real(0.07957747154594767) / (sun_alpha2 * max(cos_nl + cos_nv, Real(1e-10)));
}

FORMULA Real mirror_lobe(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return disc_lobe(s.sun_alpha2, to_light, to_viewer, normal);
}

FORMULA Vec3 no_compensation(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return Vec3(Real(0));
}

// A polynomial of sqrt(c (1 + b)/(c + b)), c the cosine and b = albedo_deficit7, which is fitted with it; where
// albedo_deficit7 is negative, b = -albedo_deficit7 and c the square of the cosine. It stands for
//   microfacets without a coat: 1 - E, the albedo that is missing in their single reflections;
//   microfacets under a smooth coat: what is missing in those of the whole stack, over what passes the
//     coat from outside; under a rough one: the same, but not over what passes;
//   a rough coat over anything else: what it reflects more than a smooth one.
FORMULA Real albedo_deficit_polynomial(Surface s, Real cosine) {
  Real c = min(max(cosine, Real(0)), Real(1));
  if (s.albedo_deficit7 < Real(0)) c = c * c;
  Real b = max(abs(s.albedo_deficit7), Real(1e-3));
  Real x = sqrt(c * (Real(1) + b) / (c + b));
  Real albedo_deficit = s.albedo_deficit6;
  albedo_deficit = albedo_deficit * x + s.albedo_deficit5;
  albedo_deficit = albedo_deficit * x + s.albedo_deficit4;
  albedo_deficit = albedo_deficit * x + s.albedo_deficit3;
  albedo_deficit = albedo_deficit * x + s.albedo_deficit2;
  albedo_deficit = albedo_deficit * x + s.albedo_deficit1;
  return albedo_deficit * x + s.albedo_deficit0;
}

FORMULA Real microfacet_albedo_deficit(Surface s, Real cosine) { return max(albedo_deficit_polynomial(s, cosine), Real(0)); }

// C. Kulla, A. Conty, "Revisiting physically based shading at Imageworks", 2017.
FORMULA Vec3 microfacet_compensation(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return s.compensation_scale *
         (microfacet_albedo_deficit(s, dot3(normal, to_light)) * microfacet_albedo_deficit(s, dot3(normal, to_viewer)));
}

// Under a reflectance map: in proportion to what the map takes away, never more than without it, so
// that no map gains energy.
FORMULA Vec3 mapped_compensation(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Vec3 part = Vec3(min(s.reflectance.x / max(s.f0.x, Real(1e-30)), Real(1)),
                   min(s.reflectance.y / max(s.f0.y, Real(1e-30)), Real(1)),
                   min(s.reflectance.z / max(s.f0.z, Real(1e-30)), Real(1)));
  return part * microfacet_compensation(s, to_light, to_viewer, normal);
}
