// Lambert: the same radiance in every direction. 1/sr, times the albedo.
FORMULA Vec3 lambert(Vec3 albedo, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  if (!(dot3(normal, to_light) > Real(0) && dot3(normal, to_viewer) > Real(0)))
    return Vec3(Real(0));
  return albedo * Real(0.31830988618379067);
}

FORMULA Vec3 lambert_brdf(Surface s, Vec3 to_light, Vec3 to_viewer, Vec3 normal) {
  return lambert(s.diffuse, to_light, to_viewer, normal);
}
