// A material's laws put together. PANWRIGHT_DIFFUSE, PANWRIGHT_LOBE and PANWRIGHT_MANY name functions
// of (Surface, to_light, to_viewer, normal), PANWRIGHT_FRESNEL one of (Surface, cosine, index
// outside), PANWRIGHT_LAYERS `bare` or `coated`.

// The surface by itself.
FORMULA Vec3 bare(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Vec3 mirrored = PANWRIGHT_FRESNEL(s, half_cosine(to_light, to_viewer), Real(1)) *
                      PANWRIGHT_LOBE(s, to_light, to_viewer, normal) +
                  PANWRIGHT_MANY(s, to_light, to_viewer, normal);
  return s.weights.x * PANWRIGHT_DIFFUSE(s, to_light, to_viewer, normal) +
         s.weights.y * (s.specular * mirrored);
}

// The surface under its coat: a peak of the coat, one of the surface below with all reflections
// between the two, and diffuse light that passes the coat twice.
FORMULA Vec3 coated(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  Real n = s.coat_index;
  Real cos_h = half_cosine(to_light, to_viewer);
  Real cos_t = refracted_cosine(cos_h, n);
  Real first = s.coat_share * fresnel_dielectric(cos_h, n);
  Vec3 below = s.weights.y * (s.specular * PANWRIGHT_FRESNEL(s, cos_t, n));
  Real peak = cook_torrance(with_sun(s.coat_alpha, s.sun_alpha2), to_light, to_viewer, normal);
  Real lower = PANWRIGHT_LOBE(s, to_light, to_viewer, tilted_normal(s, normal));
  return Vec3(first * peak) + slab_remainder(first, below, s.coat_depth, cos_t) * lower +
         through_coat(s, s.weights.x * PANWRIGHT_DIFFUSE(s, under_coat(to_light, normal, n),
                                                         under_coat(to_viewer, normal, n), normal),
                      to_light, to_viewer, normal);
}

// The reflectance of a material, 1/sr. 0 where the light is below the horizon. Near the limb of a
// smoothly shaded mesh a facet can be seen whose interpolated normal faces away: such a viewer is
// taken to the horizon, which continues the laws and leaves no dark rim.
FORMULA Vec3 surface_brdf(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  if (!(dot3(normal, to_light) > Real(0))) return Vec3(Real(0));
  Real cos_nv = dot3(normal, to_viewer);
  Vec3 seen_from = to_viewer;
  if (cos_nv < Real(1e-6)) {
    seen_from = to_viewer + normal * (Real(1e-6) - cos_nv);
    seen_from = seen_from / max(length3(seen_from), Real(1e-6));
  }
  return PANWRIGHT_LAYERS(s, to_light, seen_from, normal);
}

// The radiance towards the viewer under a distant light, what it emits included; in the units of
// the irradiance (on a plane that faces the light) per sr.
FORMULA Vec3 surface_radiance(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal,
                              Vec3 irradiance) {
  Real cos_nl = max(dot3(normal, to_light), Real(0));
  Vec3 emitted = s.emissive * (s.weights.z * Real(0.31830988618379067));
  return irradiance * (cos_nl * surface_brdf(s, to_light, to_viewer, normal) + emitted);
}
