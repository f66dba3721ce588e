// A clear layer with two faces over a surface. Light is added without regard to phase.

FORMULA Vec3 at_most_one(Vec3 v) {
  return Vec3(min(v.x, Real(1)), min(v.y, Real(1)), min(v.z, Real(1)));
}

FORMULA Vec3 at_least(Vec3 v, Real least) {
  return Vec3(max(v.x, least), max(v.y, least), max(v.z, least));
}

FORMULA Vec3 transmittance(Vec3 depth, Real path) {
  return Vec3(exp_negative(depth.x * path), exp_negative(depth.y * path),
              exp_negative(depth.z * path));
}

// What a slab with a mirror below reflects beyond its first face: (1 - R1)^2 T^2 R2/(1 - R1 R2 T^2).
FORMULA Vec3 slab_remainder(Real first, Vec3 below, Vec3 depth, Real cos_t) {
  Vec3 twice = transmittance(depth, Real(2) / max(cos_t, Real(1e-10)));
  Real passing = (Real(1) - first) * (Real(1) - first);
  Vec3 again = Vec3(Real(1)) - first * (twice * at_most_one(below));
  return passing * (twice * below / at_least(again, Real(1e-10)));
}

// What the coat's outer surface reflects of the light from a direction. Microfacets of a rough one reflect
// another share than a plane does, whose difference is fitted; over microfacets that scatter more than
// once the fit stands for those, and a rough coat passes what a smooth one does.
FORMULA Real coat_first(Surface s, Real cosine) {
  Real plane = s.coat_share * fresnel_dielectric(cosine, s.coat_index);
  if (!(s.coat_alpha > Real(0)) || dot3(s.compensation_scale, Vec3(Real(1))) > Real(0)) return plane;
  return min(max(plane + albedo_deficit_polynomial(s, cosine), Real(0)), Real(1));
}

// How much of what a mirror below reflects comes out of a slab, all reflections between its faces
// included: (1 - R1)^2 T^2/(1 - R1 R2 T^2). Where the way in and the way out differ, the smaller R1
// of the two keeps both the balance of energy and the reciprocity: (1 - R1)(1 - R1') is never over
// 1 - min(R1, R1').
FORMULA Vec3 through_both(Surface s, Vec3 below, Real cos_nl, Real cos_nv) {
  Real n = s.coat_index;
  Real first_l = coat_first(s, cos_nl);
  Real first_v = coat_first(s, cos_nv);
  Real path = Real(1) / refracted_cosine(cos_nl, n) + Real(1) / refracted_cosine(cos_nv, n);
  Vec3 twice = transmittance(s.coat_depth, min(path, Real(1e10)));
  Vec3 again = Vec3(Real(1)) - min(first_l, first_v) * (twice * at_most_one(below));
  Real passing = (Real(1) - first_l) * (Real(1) - first_v);
  return passing * (twice / at_least(again, Real(1e-10)));
}

// Diffuse light from below, through the coat twice and back and forth in it.
FORMULA Vec3 through_coat(Surface s, Vec3 below, Real cos_nl, Real cos_nv) {
  Real n = s.coat_index;
  Real passing = (Real(1) - coat_first(s, cos_nl)) * (Real(1) - coat_first(s, cos_nv));
  Real path = Real(1) / refracted_cosine(cos_nl, n) + Real(1) / refracted_cosine(cos_nv, n);
  Vec3 again = Vec3(Real(1)) - at_most_one(s.weights.x * s.diffuse) * s.coat_return;
  return passing / (n * n) *
         (transmittance(s.coat_depth, min(path, Real(1e10))) * below / at_least(again, Real(1e-10)));
}

// What microfacets under the coat scatter more than once is multiplied by this: it comes and leaves
// through the coat.
FORMULA Vec3 compensation_through_coat(Surface s, Real cos_nl, Real cos_nv) {
  Real n = s.coat_index;
  Real path = Real(1) / refracted_cosine(cos_nl, n) + Real(1) / refracted_cosine(cos_nv, n);
  Vec3 through = transmittance(s.coat_depth, min(path, Real(1e10)));
  if (s.coat_alpha > Real(0)) return through;
  Real passing = (Real(1) - coat_first(s, cos_nl)) * (Real(1) - coat_first(s, cos_nv));
  return passing * through;
}

// What the outer surface reflects.
FORMULA Real coat_peak(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal) {
  if (!(s.coat_alpha + s.bump_x > Real(0))) {
    Vec3 mirrored = disc_mirrored(light, to_viewer, normal);
    return s.coat_share * fresnel_dielectric(half_cosine(mirrored, to_viewer), s.coat_index) *
           disc_lobe(light, mirrored, to_viewer, normal) * lobe_weight(light, mirrored, normal);
  }
  Real slope_x = bumped(s.coat_alpha, s.bump_x);
  Real slope_y = bumped(s.coat_alpha, s.bump_y);
  Vec3 from = cook_torrance_from(s, slope_x, slope_y, light, to_viewer, normal, normal, Real(0));
  Real first = s.coat_share * fresnel_dielectric(half_cosine(from, to_viewer), s.coat_index);
  return first * cook_torrance_lit(s, slope_x, slope_y, from, light, to_viewer, normal, normal, Real(0)) *
         lobe_weight(light, from, normal);
}

// The mean normal of cells that are not quite parallel to their cover glass. scale: what the slopes
// as seen are multiplied by; inside a coat they are smaller by its index.
FORMULA Vec3 tilted_normal(Surface s, Vec3 normal, Real scale) {
  Vec3 across = cross3(normal, s.tangent);
  Vec3 tilted = normal - scale * s.tilt_x * s.tangent - scale * s.tilt_y * across;
  return tilted / max(length3(tilted), Real(1e-10));
}

// What a tilted microfacet shows of itself to light and viewer, against the surface that it is part of.
FORMULA Real tilted_share(Vec3 tilted, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Real light = max(dot3(tilted, to_light), Real(0)) / max(dot3(normal, to_light), Real(1e-10));
  Real viewer = max(dot3(tilted, to_viewer), Real(0)) / max(dot3(normal, to_viewer), Real(1e-10));
  return min(Real(1), min(light, viewer));
}
