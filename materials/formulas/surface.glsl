// A material's laws put together. PANWRIGHT_DIFFUSE_LAW and PANWRIGHT_SPECULAR_LAW name functions
// of (Surface, to_light, to_viewer, normal).

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
  return s.weights.x * PANWRIGHT_DIFFUSE_LAW(s, to_light, seen_from, normal) +
         s.weights.y * PANWRIGHT_SPECULAR_LAW(s, to_light, seen_from, normal);
}

// The radiance towards the viewer under a distant light, what it emits included; in the units of
// the irradiance (on a plane that faces the light) per sr.
FORMULA Vec3 surface_radiance(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal,
                              Vec3 irradiance) {
  Real cos_nl = max(dot3(normal, to_light), Real(0));
  Vec3 emitted = s.emissive * (s.weights.z * Real(0.31830988618379067));
  return irradiance * (cos_nl * surface_brdf(s, to_light, to_viewer, normal) + emitted);
}
