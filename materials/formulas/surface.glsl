// The BRDFs of a material put together, under one light. PANWRIGHT_DIFFUSE and PANWRIGHT_COMPENSATION name
// functions of directions (Surface, to_light, to_viewer, normal): a disc does not change them. PANWRIGHT_FROM and
// PANWRIGHT_LOBE name what disc.glsl has of a lobe: the direction of the disc from which most of its light comes,
// and the lobe for it, of (Surface, [from,] Incidence, to_viewer, normal, normal of the microfacets, index of a
// coat over them or 0). PANWRIGHT_FRESNEL names one of (Surface, cosine, index outside), PANWRIGHT_LAYERS `bare`,
// `coated` or `coated_mirror`.

// microfacets, `outer` over them.
FORMULA Vec3 mirrored(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal, Real outer) {
  Vec3 from = PANWRIGHT_FROM(s, light, to_viewer, normal, normal, Real(0));
  Real peak = PANWRIGHT_LOBE(s, from, light, to_viewer, normal, normal, Real(0)) * lobe_weight(light, from, normal);
  return s.specular * (PANWRIGHT_FRESNEL(s, half_cosine(from, to_viewer), outer) * peak +
                       PANWRIGHT_COMPENSATION(s, light.to_light, to_viewer, normal));
}

// The surface by itself.
FORMULA Vec3 bare(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal) {
  return s.weights.x * PANWRIGHT_DIFFUSE(s, light.to_light, to_viewer, normal) +
         s.weights.y * mirrored(s, light, to_viewer, normal, Real(1));
}

FORMULA Vec3 coated_diffuse(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Vec3 below = PANWRIGHT_DIFFUSE(s, under_coat(to_light, normal, s.coat_index),
                                 under_coat(to_viewer, normal, s.coat_index), normal);
  return through_coat(s, s.weights.x * below, max(dot3(normal, to_light), Real(0)),
                      max(dot3(normal, to_viewer), Real(0)));
}

// Microfacets under the coat. They receive refracted light: at normal incidence slopes look larger by the
// coat's index from outside, towards grazing by more. What is reflected so flat that the coat keeps
// it is lost here, and comes back in coated_compensation.
FORMULA Vec3 coated_microfacets(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal) {
  Real n = s.coat_index;
  Vec3 tilted = tilted_normal(s, normal, Real(1) / n);
  Vec3 from = PANWRIGHT_FROM(s, light, to_viewer, normal, tilted, n);
  Vec3 l = under_coat(from, normal, n);
  Vec3 v = under_coat(to_viewer, normal, n);
  Vec3 below = s.weights.y * s.specular * PANWRIGHT_FRESNEL(s, half_cosine(l, v), n);
  Vec3 through = through_both(s, below, max(dot3(normal, from), Real(0)),
                              max(dot3(normal, to_viewer), Real(0)));
  Real share = s.weights.y * tilted_share(tilted, l, v, normal) / (n * n);
  Real peak = PANWRIGHT_LOBE(s, from, light, to_viewer, normal, tilted, n) * lobe_weight(light, from, normal);
  return share * (through * (s.specular * (PANWRIGHT_FRESNEL(s, half_cosine(l, v), n) * peak)));
}

// What microfacets and coat send back and forth until it leaves.
FORMULA Vec3 coated_compensation(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Vec3 through = compensation_through_coat(s, max(dot3(normal, to_light), Real(0)),
                                   max(dot3(normal, to_viewer), Real(0)));
  return s.weights.y * s.specular * through * PANWRIGHT_COMPENSATION(s, to_light, to_viewer, normal);
}

// The surface under its coat: a peak of the coat, one of the surface below with all reflections
// between the two, and diffuse light that passes the coat twice.
FORMULA Vec3 coated(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal) {
  return Vec3(coat_peak(s, light, to_viewer, normal)) +
         coated_microfacets(s, light, to_viewer, normal) +
         coated_compensation(s, light.to_light, to_viewer, normal) +
         coated_diffuse(s, light.to_light, to_viewer, normal);
}

// What a mirror under the coat sends from one direction to another, lobe apart. tilted: the cosine
// of both to the mirror's normal.
FORMULA Vec3 coated_reflection(Surface s, Real tilted, Real cos_nl, Real cos_nv) {
  Real cos_t = refracted_cosine(tilted, s.coat_index);
  Vec3 below = s.weights.y * s.specular * PANWRIGHT_FRESNEL(s, cos_t, s.coat_index);
  return below * through_both(s, below, cos_nl, cos_nv);
}

// A mirror under the coat: light leaves at the angle it came at, whatever the coat bends it.
FORMULA Vec3 coated_mirror(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal) {
  Vec3 tilted = tilted_normal(s, normal, Real(1));
  Vec3 from = PANWRIGHT_FROM(s, light, to_viewer, normal, tilted, Real(0));
  Real peak = tilted_share(tilted, from, to_viewer, normal) *
              PANWRIGHT_LOBE(s, from, light, to_viewer, normal, tilted, Real(0)) *
              lobe_weight(light, from, normal);
  return Vec3(coat_peak(s, light, to_viewer, normal)) +
         peak * coated_reflection(s, half_cosine(from, to_viewer), max(dot3(normal, from), Real(0)),
                                  max(dot3(normal, to_viewer), Real(0))) +
         coated_compensation(s, light.to_light, to_viewer, normal) +
         coated_diffuse(s, light.to_light, to_viewer, normal);
}

// The reflectance of a material, 1/sr. 0 where the light is below the horizon. Near the limb of a
// smoothly shaded mesh a microfacet can be seen whose interpolated normal faces away: such a viewer is
// taken to the horizon, which continues the BRDFs and leaves no dark rim.
FORMULA Vec3 surface_brdf(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal) {
  if (!(dot3(normal, light.to_light) > Real(0))) return Vec3(Real(0));
  Real cos_nv = dot3(normal, to_viewer);
  Vec3 seen_from = to_viewer;
  if (cos_nv < Real(1e-6)) {
    seen_from = to_viewer + normal * (Real(1e-6) - cos_nv);
    seen_from = seen_from / max(length3(seen_from), Real(1e-6));
  }
  return PANWRIGHT_LAYERS(s, light, seen_from, normal);
}

// The radiance reflected towards the viewer under the light; in the units of its irradiance per sr.
FORMULA Vec3 surface_radiance(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal) {
  Real cos_nl = max(dot3(normal, light.to_light), Real(0));
  return light.irradiance * (cos_nl * surface_brdf(s, light, to_viewer, normal));
}

// Of light that is wide beside lobes, and needs no more of them than what they send in all: the
// diffuse part, and microfacets without a coat as a mirror. `coated_diffuse` and `coated_reflection`
// are those of coats.
FORMULA Vec3 bare_diffuse(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return s.weights.x * PANWRIGHT_DIFFUSE(s, to_light, to_viewer, normal);
}

FORMULA Vec3 bare_reflection(Surface s, Real cosine) {
  return s.weights.y * s.specular * PANWRIGHT_FRESNEL(s, cosine, Real(1));
}
