// microfacets with Smith's masking, correlated by height, and what they scatter more than once.
// Slopes: RMS of the microfacets along the tangent (x) and across it (y). Where the two are one, or the
// tangent is 0, microfacets are isotropic and of slope sqrt(x y). 1/sr.
// B. Walter et al., "Microfacet models for refraction through rough surfaces", 2007; E. Heitz,
// "Understanding the masking-shadowing function in microfacet-based BRDFs", 2014.

// A slope within 1e-6 (a thousandth of what the Sun's disc blurs) to 1000.
FORMULA Real microfacet_slope(Real alpha) { return min(max(alpha, Real(1e-6)), Real(1000)); }

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

// D G / (4 (n.l) (n.v)) with Beckmann's masking. density: D pi slope_x slope_y cos^4, under a point
// Sun exp(-y^2) of the half vector's slopes y over alpha.
FORMULA Real beckmann_masked(Real density, Real slope_x, Real slope_y, Vec3 tangent, Vec3 to_light,
                             Vec3 to_viewer, Vec3 normal) {
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  cos_nl = max(cos_nl, Real(1e-10));
  cos_nv = max(cos_nv, Real(1e-10));
  Vec3 both = to_light + to_viewer;
  if (dot3(both, both) < Real(1e-12)) return Real(0);
  Vec3 turned = cross3(normal, both);
  Real scale = Real(1) / ((cos_nl + cos_nv) * (cos_nl + cos_nv));
  Real secant2 = Real(1) + dot3(turned, turned) * scale;
  Real d = density * secant2 * secant2 * Real(0.31830988618379067) / (slope_x * slope_y);
  Real sine_l = sloped_sine(slope_x, slope_y, tangent, to_light, normal);
  Real sine_v = sloped_sine(slope_x, slope_y, tangent, to_viewer, normal);
  Real hidden = cos_nl * beckmann_masking(cos_nv, sine_v) + cos_nv * beckmann_masking(cos_nl, sine_l);
  return Real(0.25) * d / (cos_nl * cos_nv + hidden);
}

FORMULA Real beckmann_smith(Real slope_x, Real slope_y, Vec3 tangent, Vec3 to_light, Vec3 to_viewer,
                            Vec3 normal) {
  Real cos_sum = max(dot3(normal, to_light), Real(1e-10)) + max(dot3(normal, to_viewer), Real(1e-10));
  Real scale = Real(1) / (cos_sum * cos_sum);
  Vec3 turned = cross3(normal, to_light + to_viewer);
  Real density = exp_negative(over_slopes(slope_x, slope_y, tangent, turned, normal) * scale);
  if (!(density > Real(0))) return Real(0);
  return beckmann_masked(density, slope_x, slope_y, tangent, to_light, to_viewer, normal);
}

// The masking of GGX: what D is multiplied by.
FORMULA Real ggx_masked(Real d, Real slope_x, Real slope_y, Vec3 tangent, Vec3 to_light, Vec3 to_viewer,
                        Vec3 normal) {
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  cos_nl = max(cos_nl, Real(1e-10));
  cos_nv = max(cos_nv, Real(1e-10));
  Real sine_l = sloped_sine(slope_x, slope_y, tangent, to_light, normal);
  Real sine_v = sloped_sine(slope_x, slope_y, tangent, to_viewer, normal);
  Real toward_l = cos_nv * sqrt(cos_nl * cos_nl + sine_l * sine_l);
  Real toward_v = cos_nl * sqrt(cos_nv * cos_nv + sine_v * sine_v);
  return Real(0.5) * d / (toward_l + toward_v);
}

// D G / (4 (n.l) (n.v)) with the distribution of Trowbridge and Reitz, GGX.
FORMULA Real ggx_smith(Real slope_x, Real slope_y, Vec3 tangent, Vec3 to_light, Vec3 to_viewer,
                       Vec3 normal) {
  Real cos_sum = max(dot3(normal, to_light), Real(1e-10)) + max(dot3(normal, to_viewer), Real(1e-10));
  Vec3 both = to_light + to_viewer;
  if (dot3(both, both) < Real(1e-12)) return Real(0);
  Vec3 turned = cross3(normal, both);
  Real sum2 = cos_sum * cos_sum;
  Real ratio = (sum2 + dot3(turned, turned)) / (sum2 + over_slopes(slope_x, slope_y, tangent, turned, normal));
  Real d = ratio * ratio * Real(0.31830988618379067) / (slope_x * slope_y);
  return ggx_masked(d, slope_x, slope_y, tangent, to_light, to_viewer, normal);
}

// lit_from() and the density's mean of microfacets under the disc. index: of a coat over them, 0: none
FORMULA Vec3 microfacets_from(Surface s, Real heavy, Real slope_x, Real slope_y, Incidence light, Vec3 to_viewer,
                              Vec3 normal, Vec3 tilted, Real index) {
  if (point_light(light, min(slope_x, slope_y), to_viewer, tilted) > Real(0)) return light.to_light;
  return lit_from(heavy, light, min(slope_x, slope_y), over_slope_x(slope_x, slope_y, s.tangent, tilted),
                  over_slope_y(slope_x, slope_y, s.tangent, tilted), to_viewer, normal, tilted, index);
}
FORMULA Real microfacets_density(Surface s, Real heavy, Real slope_x, Real slope_y, Vec3 from, Incidence light,
                                 Vec3 to_viewer, Vec3 normal, Vec3 tilted, Real index) {
  return density_over_disc(heavy, Real(0), light, min(slope_x, slope_y),
                           over_slope_x(slope_x, slope_y, s.tangent, tilted),
                           over_slope_y(slope_x, slope_y, s.tangent, tilted), from, to_viewer,
                           normal, tilted, index);
}

FORMULA Real beckmann_lit(Surface s, Real slope_x, Real slope_y, Vec3 from, Incidence light, Vec3 to_viewer,
                             Vec3 normal, Vec3 tilted, Real index) {
  if (point_light(light, min(slope_x, slope_y), to_viewer, tilted) > Real(0))
    return beckmann_smith(slope_x, slope_y, s.tangent, below_index(light.to_light, normal, index),
                          below_index(to_viewer, normal, index), tilted);
  Real density = microfacets_density(s, Real(0), slope_x, slope_y, from, light, to_viewer, normal, tilted, index);
  if (!(density > Real(0))) return Real(0);
  return beckmann_masked(density, slope_x, slope_y, s.tangent, below_index(from, normal, index),
                         below_index(to_viewer, normal, index), tilted);
}

FORMULA Vec3 beckmann_lobe_from(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted, Real index) {
  Real inside = bump_inside(s, light.to_light, to_viewer, index);
  return microfacets_from(s, Real(0), microfacet_slope(bumped(s.alpha_x, inside * s.bump_x)),
                          microfacet_slope(bumped(s.alpha_y, inside * s.bump_y)), light, to_viewer, normal, tilted,
                          index);
}

FORMULA Real beckmann_lobe(Surface s, Vec3 from, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                           Real index) {
  Real inside = bump_inside(s, light.to_light, to_viewer, index);
  return beckmann_lit(s, microfacet_slope(bumped(s.alpha_x, inside * s.bump_x)),
                         microfacet_slope(bumped(s.alpha_y, inside * s.bump_y)), from, light, to_viewer, normal,
                         tilted, index);
}

// GGX over Gaussian bumps, whose mean it is: GGX is the mean of Gaussians of slopes alpha/sqrt(u) over
// exp(-u) du, and each becomes wider by the bumps. The integral by the trapezoidal rule in log(u), within
// 1e-3 to 10 alpha. D pi cos^4; own, bump, square: squared slopes along the tangent and across
FORMULA Real ggx_bumped_part(Real u, Real weight, Vec3 own, Vec3 bump, Vec3 square) {
  Real x = own.x + u * bump.x;
  Real y = own.y + u * bump.y;
  return weight * exp_negative(u * (square.x / x + square.y / y)) / sqrt(x * y);
}
FORMULA Real ggx_bumped(Vec3 own, Vec3 bump, Vec3 square) {
  return ggx_bumped_part(Real(0.00247875218), Real(7.37533385e-06), own, bump, square) +
         ggx_bumped_part(Real(0.00822974705), Real(8.08333941e-05), own, bump, square) +
         ggx_bumped_part(Real(0.0273237224), Real(0.000874188649), own, bump, square) +
         ggx_bumped_part(Real(0.0907179533), Real(0.0090444082), own, bump, square) +
         ggx_bumped_part(Real(0.301194212), Real(0.0807752357), own, bump, square) +
         ggx_bumped_part(Real(1), Real(0.442687738), own, bump, square) +
         ggx_bumped_part(Real(3.32011692), Real(0.479501834), own, bump, square) +
         ggx_bumped_part(Real(11.0231764), Real(0.00238616688), own, bump, square);
}

// cosine Lambda(direction) of GGX microfacets; see beckmann_masking.
FORMULA Real ggx_masking(Real cosine, Real sine) {
  return Real(0.5) * (sine * sine / (cosine + sqrt(cosine * cosine + sine * sine)));
}

// Microfacets hide each other as they do, bumps as a Gaussian surface does.
FORMULA Real ggx_bumped_masked(Real d, Surface s, Real inside, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Real cos_nl = dot3(normal, to_light);
  Real cos_nv = dot3(normal, to_viewer);
  if (!(cos_nl > Real(0) && cos_nv > Real(0))) return Real(0);
  cos_nl = max(cos_nl, Real(1e-10));
  cos_nv = max(cos_nv, Real(1e-10));
  Real own_x = microfacet_slope(s.alpha_x);
  Real own_y = microfacet_slope(s.alpha_y);
  Real bump_x = microfacet_slope(sqrt(inside * s.bump_x));
  Real bump_y = microfacet_slope(sqrt(inside * s.bump_y));
  Real hidden_l = ggx_masking(cos_nl, sloped_sine(own_x, own_y, s.tangent, to_light, normal)) +
                  beckmann_masking(cos_nl, sloped_sine(bump_x, bump_y, s.tangent, to_light, normal));
  Real hidden_v = ggx_masking(cos_nv, sloped_sine(own_x, own_y, s.tangent, to_viewer, normal)) +
                  beckmann_masking(cos_nv, sloped_sine(bump_x, bump_y, s.tangent, to_viewer, normal));
  return Real(0.25) * d / (cos_nl * cos_nv + cos_nl * hidden_v + cos_nv * hidden_l);
}

// Whether bumps are not much smaller than the microfacets, and both larger than what the light's disc blurs.
FORMULA Real ggx_is_bumped(Surface s, Incidence light, Real inside) {
  if (!(s.bump_x > Real(0))) return Real(0);
  Real x = inside * s.bump_x;
  Real y = inside * s.bump_y;
  Real x2 = s.alpha_x * s.alpha_x;
  Real y2 = s.alpha_y * s.alpha_y;
  if (min(x + x2, y + y2) > Real(1000) * light.alpha2 && max(x - Real(1e-3) * x2, y - Real(1e-3) * y2) > Real(0))
    return Real(1);
  return Real(0);
}

FORMULA Vec3 ggx_lobe_from(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted, Real index) {
  Real inside = bump_inside(s, light.to_light, to_viewer, index);
  if (ggx_is_bumped(s, light, inside) > Real(0)) return light.to_light;
  return microfacets_from(s, Real(1), microfacet_slope(bumped(s.alpha_x, inside * s.bump_x)),
                          microfacet_slope(bumped(s.alpha_y, inside * s.bump_y)), light, to_viewer, normal, tilted,
                          index);
}

FORMULA Real ggx_lobe(Surface s, Vec3 from, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted, Real index) {
  Real inside = bump_inside(s, light.to_light, to_viewer, index);
  Real slope_x = microfacet_slope(bumped(s.alpha_x, inside * s.bump_x));
  Real slope_y = microfacet_slope(bumped(s.alpha_y, inside * s.bump_y));
  Vec3 l = below_index(from, normal, index);
  Vec3 v = below_index(to_viewer, normal, index);
  if (ggx_is_bumped(s, light, inside) > Real(0)) {
    Vec3 both = l + v;
    Real sum = dot3(tilted, both);
    if (!(sum > Real(1e-6))) return Real(0);
    Vec3 turned = cross3(tilted, both);
    Real along = dot3(turned, cross3(tilted, s.tangent)) / sum;
    Real across = dot3(turned, s.tangent) / sum;
    Real own_x = microfacet_slope(s.alpha_x);
    Real own_y = microfacet_slope(s.alpha_y);
    Real density = ggx_bumped(Vec3(own_x * own_x, own_y * own_y, Real(0)), inside * Vec3(s.bump_x, s.bump_y, Real(0)),
                              Vec3(along * along, across * across, Real(0)));
    Real tan2 = dot3(turned, turned) / (sum * sum);
    return ggx_bumped_masked(density * (Real(1) + tan2) * (Real(1) + tan2) * Real(0.31830988618379067), s, inside, l, v,
                             tilted);
  }
  if (point_light(light, min(slope_x, slope_y), to_viewer, tilted) > Real(0))
    return ggx_smith(slope_x, slope_y, s.tangent, l, v, tilted);
  Vec3 turned = cross3(tilted, l + v);
  Real cos_sum = dot3(tilted, l + v);
  if (!(cos_sum > Real(1e-6))) return Real(0);
  Real secant2 = Real(1) + dot3(turned, turned) / (cos_sum * cos_sum);
  Real density = microfacets_density(s, Real(1), slope_x, slope_y, from, light, to_viewer, normal, tilted, index);
  Real d = density * secant2 * secant2 * Real(0.31830988618379067) / (slope_x * slope_y);
  return ggx_masked(d, slope_x, slope_y, s.tangent, l, v, tilted);
}

// A mirror, by itself or below a coat, whose passing stands apart: light leaves at the angle it came
// at, whatever the coat bends it. A rough coat bends light twice by index - 1 times its slopes: as
// much as a mirror of slopes (index - 1)/sqrt 2 times them does.
FORMULA Real mirror_bent(Surface s) {
  return (s.coat_index - Real(1)) * Real(0.7071067811865476) * s.coat_alpha;
}

FORMULA Vec3 mirror_lobe_from(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted, Real index) {
  if (!(mirror_bent(s) + s.bump_x > Real(0))) return disc_mirrored(light, to_viewer, tilted);
  Real slope_x = microfacet_slope(bumped(mirror_bent(s), s.bump_x));
  Real slope_y = microfacet_slope(bumped(mirror_bent(s), s.bump_y));
  return microfacets_from(s, Real(0), slope_x, slope_y, light, to_viewer, normal, tilted, Real(0));
}

FORMULA Real mirror_lobe(Surface s, Vec3 from, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                         Real index) {
  if (!(mirror_bent(s) + s.bump_x > Real(0)))
    return disc_lobe(light, from, to_viewer, tilted);
  Real slope_x = microfacet_slope(bumped(mirror_bent(s), s.bump_x));
  Real slope_y = microfacet_slope(bumped(mirror_bent(s), s.bump_y));
  return beckmann_lit(s, slope_x, slope_y, from, light, to_viewer, normal, tilted, Real(0));
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
