// No highlight.
FORMULA Vec3 no_specular_lobe_from(Surface s, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted, Real index) {
  return light.to_light;
}

FORMULA Real no_specular_lobe(Surface s, Vec3 from, Incidence light, Vec3 to_viewer, Vec3 normal, Vec3 tilted,
                              Real index) {
  return Real(0);
}
